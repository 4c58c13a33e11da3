//! Judges pictures that other renderers made of a known scene and camera, as methods are judged.
//!
//! ```no_run
//! use skiagraph_compare::foreign::judging::{Judging, judge};
//! use skiagraph_compare::{measuring::device::GpuRequest, sink::Silent};
//! use skiagraph_gpu::block_on;
//! use skiagraph_scene::SceneLibrary;
//!
//! let (scene, _) = SceneLibrary::default().load("park")?;
//! let view = scene.views[0].clone();
//! let judging = Judging { pictures: vec!["factor.exr".into()], ..Judging::default() };
//! let judged = block_on(judge(&judging, scene, &view, &GpuRequest::default(), &Silent))?;
//! println!("{} pixels wrong", judged.record.pictures[0].wrong_attributable());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod conventions;
mod decoded;
mod elsewhere;
mod exr_file;
pub mod factor;
pub mod judging;
mod npy_file;
pub mod raster;
pub mod surfaces;
mod suspicions;
pub mod truth;
