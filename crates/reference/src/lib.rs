//! The reference against which Skiagraph measures shadow methods: an f64 ray tracer ([`Oracle`]), pixel counts
//! ([`Statistics`]) and pictures ([`Image`]).
//!
//! The oracle starts from what a GPU's G-buffer says each pixel shows (one primitive id per pixel), recomputes the hit on
//! that primitive in f64, traces a shadow ray in f64, and marks the pixels *in band*, whose answer flips when
//! receiver or casters move by their own f32 rounding error. It knows no GPU and writes no files.
//!
//! ```
//! use skiagraph_reference::{Oracle, OracleMode, Progress, Statistics};
//! use skiagraph_scene::{DirectionalLight, Mesh, View};
//! use glam::DVec3;
//!
//! let mesh = Mesh::default();
//! let view = View {
//!     name: "main".into(), eye: DVec3::ZERO, direction: DVec3::NEG_Z, up: DVec3::Y,
//!     fov_y_degrees: 60.0, near: 0.1, far: 100.0,
//! };
//! let light = DirectionalLight { direction: DVec3::NEG_Y };
//! let camera = view.camera([8, 8]);
//! let oracle = Oracle::new(&mesh);
//! let primitives = oracle.primary(&camera, Progress::default())?;
//! let reference = oracle.shade(&camera, &light, &primitives, OracleMode::Exact, Progress::default())?;
//! let counts = Statistics::judged(&reference.visibility(), &reference.status(), &reference)?;
//! assert_eq!(counts.pixels.background, 64);
//! assert_eq!(counts.wrong.total, 0);
//! # Ok::<(), skiagraph_reference::Error>(())
//! ```

mod band;
mod error;
pub mod image;
pub mod oracle;
mod ray;
mod receiver;
pub mod statistics;
mod tree;
pub mod twin;

pub use error::Error;
pub use image::Image;
pub use oracle::{BACKGROUND, Class, Occlusion, Oracle, OracleMode, Progress, Reference};
pub use statistics::{CertainCounts, ClassSplit, PixelCounts, Split, Statistics, WrongCounts};
