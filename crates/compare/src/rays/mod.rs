//! Rays by themselves, without a method: how many a second each engine of `Trace` answers, and how
//! many it answers wrongly.
//!
//! ```no_run
//! use skiagraph_compare::{
//!     measuring::device::{self, GpuRequest},
//!     rays::{conformance::{RAY_QUERIES, conformance}, speed::{SpeedRequest, any_hits}},
//!     sink::{Session, Silent},
//! };
//! use skiagraph_scene::{SceneLibrary, SceneRequest};
//! use std::sync::Arc;
//!
//! let request = SceneRequest { argument: "park".into(), obj: None };
//! let (scene, _) = SceneLibrary::from_environment().load(&request)?;
//! let gpu = device::open_with(&GpuRequest::default(), RAY_QUERIES)?;
//! let session = Session::new(&gpu, &Silent);
//! let speed = any_hits(session, &SpeedRequest::new(vec![Arc::new(scene)], 512, 5))?;
//! println!("{:.1} million rays a second", speed.sets[0].engines[0].mrays_per_s);
//! let answers = conformance(session, 1_000_000)?;
//! println!("{} rays are answered wrongly", answers.wrong());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod conformance;
pub mod solids;
pub mod speed;
pub mod tracer;
