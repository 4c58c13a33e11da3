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
//! A [`Comparison`](comparison::Comparison) names methods, a scene, the places that it is seen from
//! and a [`Protocol`](comparison::Protocol); [`run`](measuring::series::run) returns
//! [`Results`](records::results::Results): for each run the pixels that are wrong against an exact
//! reference, and times. A [`Sink`](sink::Sink) hears of the work and may end it early. To keep
//! results in a folder, and to go on from those that are there, take a
//! [`Series`](measuring::series::Series) step by step. So an engine's own tests can ask which
//! methods are right on a scene of that engine (`tests/it/engine.rs`).
//!
//! - [`graphs`]: from a name to a method that can run.
//! - [`measuring`]: runs, times and judges.
//! - [`records`]: measurements as plain data and as files.
//! - [`pictures`]: texels as pictures.
//! - [`files`]: writing whole files, locks, watching.

pub mod comparison;
pub mod default_view;
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
