//! Runs, times and judges shadow methods on a scene: the program `skiagraph compare` as a library.
//!
//! ```no_run
//! use skiagraph_compare::{
//!     comparison::Comparison,
//!     graphs::shadow_method::load_methods,
//!     measuring::{device::{self, GpuRequest}, series::run},
//!     sink::{Session, Silent},
//! };
//! use skiagraph_passes::EmbeddedSources;
//! use skiagraph_scene::{SceneLibrary, SceneRequest};
//! use std::sync::Arc;
//!
//! let request = SceneRequest { argument: "park".into(), obj: None };
//! let (scene, _) = SceneLibrary::from_environment().load(&request)?;
//! let methods = load_methods(&["light_buffer", "nsm@bias=0"], &[], &[1024], &EmbeddedSources)?;
//! let gpu = device::open(&GpuRequest::default(), methods.iter().map(|it| &it.preset.graph))?;
//! let comparison = Comparison::new(Arc::new(scene), methods)?;
//! for run in run(&comparison, Session::new(&gpu, &Silent))?.runs {
//!     let measured = run.measured.ok_or("cannot run here")?;
//!     println!("{}: {} wrong of {}", run.preset, measured.wrong.total, run.pixels.facing_light);
//! }
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! A [`Comparison`](comparison::Comparison) holds methods, a scene, the views and camera paths from
//! which it is seen, and a [`Protocol`](comparison::Protocol). [`run`](measuring::series::run)
//! returns [`Results`](records::results::Results): for each run its times, and the pixels that are
//! wrong against an exact reference. A [`Sink`](sink::Sink) receives the progress of the work and
//! may end it early. To write results into a folder, and to continue from earlier ones in it, use a
//! [`Series`](measuring::series::Series) step by step. In this way an engine's own tests can find
//! out which methods are right on a scene of that engine (`tests/it/engine.rs`).
//!
//! - [`graphs`]: turns names into methods that can run.
//! - [`measuring`]: runs methods, times them and judges their pictures.
//! - [`records`]: holds measurements as plain data, and reads and writes their files.
//! - [`pictures`]: writes texels as pictures.
//! - [`foreign`]: judges pictures of other renderers.
//! - [`rays`]: times and judges rays without a method.
//! - [`adapters`]: finds out about one adapter what there is to find out.
//! - [`files`]: writes, locks and watches files.

pub mod adapters;
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
pub mod pictures;
pub mod quantities;
pub mod rays;
pub mod records;
pub mod sink;
pub mod size;
pub mod wording;
