//! Runs, times and judges shadow methods on a scene: what the program `skiagraph compare` does, as
//! a library, so that an engine's own tests can ask it.
//!
//! A [`Comparison`](comparison::Comparison) names methods, a scene, the places that it is seen from
//! and a [`Protocol`](comparison::Protocol); [`run`](measuring::series::run) returns
//! [`Results`](records::results::Results): for each run the pixels that are wrong against an exact
//! reference, and times. A [`Sink`](sink::Sink) hears of the work and may end it early. To keep
//! results in a folder, and to go on from those that are there, take a
//! [`Series`](measuring::series::Series) step by step.
//!
//! - [`graphs`]: from a name to a method that can run.
//! - [`measuring`]: runs, times and judges.
//! - [`records`]: measurements as plain data and as files.
//! - [`pictures`]: texels as pictures.
//! - [`files`]: writing whole files, locks, watching.

pub mod comparison;
pub mod error;
pub mod files;
pub mod graphs;
pub mod lists;
pub mod measuring;
pub mod pictures;
pub mod records;
pub mod sink;
pub mod size;
pub mod wording;
