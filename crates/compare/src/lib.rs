#![doc = include_str!("../README.md")]
//!
//! A [`Comparison`](comparison::Comparison) holds methods, a scene, the views and camera paths from
//! which it is seen, and a [`Protocol`](comparison::Protocol). [`run`](measuring::series::run)
//! returns [`Results`](records::results::Results): for each run its times, and the pixels that are
//! wrong against an exact reference. A [`Sink`](sink::Sink) receives the progress of the work and
//! may end it early. What waits for the GPU is `async`, so that a host that cannot wait drives it,
//! too; [`block_on`](skiagraph_gpu::block_on) waits on its thread. To write results into a folder,
//! and to continue from earlier ones in it, use a [`Series`](measuring::series::Series) step by
//! step. In this way an engine's own tests can find out which methods are right on a scene of that
//! engine (`crates/compare/tests/it/engine.rs` in the repository).
//!
//! - [`graphs`]: turns names into methods that can run.
//! - [`measuring`]: runs methods, times them and judges their pictures.
//! - [`records`]: holds measurements as plain data, and reads and writes their files.
//! - [`pictures`]: writes texels as pictures.
//! - [`foreign`]: judges pictures of other renderers.
//! - [`files`]: writes, locks and watches files.
//!
//! # Terms
//!
//! - *Method* ([`Method`](graphs::method::Method)): a shadow method in one setting of its
//!   [params](skiagraph_graph::Param). Its *preset* ([`Preset`](graphs::preset::Preset)) is the
//!   graph that it runs, read from a RON *document*: one that ships with Skiagraph, or one of your
//!   own with the output `visibility`.
//! - *Run* ([`Run`](records::results::Run)): one method on one view or camera path, in one
//!   viewport. *Cell*: a run together with the protocol, under an id that is the same on every
//!   machine ([`cell::id`](measuring::cell::id)).
//! - *Reference*, *ground truth*, *truth*: the exact answer that methods are judged against. The
//!   *oracle*, a ray tracer in f64, finds it ([`skiagraph_reference`]).
//! - *Receiver*: the point of a surface that a pixel shows. *Caster*: a triangle that may keep the
//!   light from it. A pixel *faces the light* if its receiver does.
//! - *Band*: the *indeterminate* pixels, whose right answer flips when receiver or casters move
//!   within the rounding error of f32. Errors there do not count against a method, so that tables
//!   count wrong pixels *outside the band*.
//! - *Certain*, *uncertain*: a method's own verdict on each pixel, its output
//!   [`status`](skiagraph_reference::status): certain where its shadow map decides the answer.
//! - *Light with an extent*: a sun with an angular diameter, or a lamp with a radius. *Share of
//!   light*: the part of the light that arrives at a pixel, 0 in shadow to 1 in full light. Answers
//!   that are shares are *graded*, answers of 0 and 1 *hard*.
//! - *Step* of a method: its passes with the same name up to the first dot
//!   ([`step`](records::results::step())).
//! - Times are of frames in which *every pass runs*, of a path's frames, and of frames before each
//!   of which the same has moved (a [`Regime`](records::regimes::Regime)), so that passes with
//!   unchanged inputs are skipped. *Upkeep* is the CPU's work for such a frame. Methods are timed
//!   *in turns*, frame by frame.
//! - *Early end*: the work stops because [`Sink::stop`](sink::Sink::stop) asks for it; the error is
//!   [`CompareError::Interrupted`](error::CompareError::Interrupted).
//! - *Steady state* ([`Steady`](records::steady::Steady)): some methods reuse results of earlier
//!   frames. On a still view their pictures change at first and then repeat; the pictures that
//!   repeat are the steady state.

pub mod comparison;
pub mod default_view;
pub mod error;
pub mod files;
pub mod foreign;
pub mod graphs;
pub mod lists;
pub mod measuring;
pub mod own_camera;
pub mod own_scene;
pub mod own_scene_notes;
pub mod pictures;
pub mod quantities;
pub mod records;
pub mod sink;
pub mod size;
pub mod wording;
