//! The reference against which Skiagraph measures shadow methods: an f64 ray tracer ([`Oracle`]),
//! the [`GroundTruth`] that it finds, pixel counts ([`Statistics`]) and pictures ([`Image`]).
//!
//! The oracle starts from what a GPU's G-buffer says each pixel shows (one primitive id per pixel),
//! recomputes the hit on that primitive in f64, traces a shadow ray in f64, and marks the pixels
//! *indeterminate*: their answer flips when receiver or casters move within their f32 error bounds.
//! It knows no GPU and writes no files.
//!
//! ```
//! use skiagraph_reference::{Oracle, OracleMode, Progress, Statistics};
//! use skiagraph_scene::{DirectionalLight, Mesh, View};
//! use glam::DVec3;
//!
//! let mesh = Mesh::default();
//! let view = View { far: 100.0, ..View::default() };
//! let light = DirectionalLight::new(DVec3::NEG_Y);
//! let camera = view.camera([8, 8]);
//! let oracle = Oracle::new(&mesh);
//! let primitives = oracle.primary(&camera, Progress::default())?;
//! let (mode, progress) = (OracleMode::Exact, Progress::default());
//! let truth = oracle.shade(&camera, &light, &primitives, mode, progress)?;
//! let counts = Statistics::judged(&truth.visibility(), &truth.status(), &truth)?;
//! assert_eq!(counts.pixels.background, 64);
//! assert_eq!(counts.wrong.total, 0);
//! # Ok::<(), skiagraph_reference::Error>(())
//! ```
//!
//! # Terms
//!
//! - *Primitive*: a triangle of the mesh. Its *id* is its index in
//!   [`Mesh::triangles`](skiagraph_scene::Mesh::triangles).
//! - *G-buffer*: the primitive id that each pixel shows, row by row from the top left.
//! - *Receiver* ([`Receiver`]): the point of a surface that a pixel shows. *Caster*: a triangle
//!   that may keep the light from it.
//! - *PFL*: the pixels that face the light ([`Class::faces_light`]). Shares of errors are shares of
//!   their number.
//! - *Band*: the indeterminate pixels ([`GroundTruthPixels::indeterminate`]). Errors there are
//!   excused.
//! - *Certain*, *uncertain*: a method's own verdict on a pixel, its output [`status`].
//! - *Light with extent*, *area light*: a sun with an angular diameter, or a lamp with a radius. A
//!   pixel sees a *share* of it, 0 to 1.

pub mod area;
pub mod attribution;
pub mod blockers;
mod contact;
pub mod edge;
mod error;
pub mod error_bound;
pub mod flip;
pub mod graded;
pub mod ground_truth;
pub mod image;
pub mod layer_jump;
mod masked;
pub mod oracle;
pub mod pixels;
mod ray;
pub mod receiver;
pub mod shimmer;
pub mod sight;
pub mod statistics;
pub mod status;
mod strata;
mod sums;
pub mod texels;
mod tree;
mod visible;

pub use area::ground_truth;
pub use attribution::unattributable;
pub use blockers::{BlockerCounts, blockers, nearest_blockers};
pub use edge::{Distances, EdgeDistances};
pub use error::Error;
pub use graded::{Graded, Invalid, JudgedPixels, OffBy, SoftErrors};
pub use ground_truth::{AreaVisibility, Class, GroundTruth, GroundTruthPixels};
pub use image::Image;
pub use layer_jump::LayerJump;
pub use oracle::{Occlusion, Oracle, OracleMode, unshadowed};
pub use pixels::{BACKGROUND, Progress};
pub use receiver::Receiver;
pub use shimmer::Shimmer;
pub use sight::{Sight, sights};
pub use statistics::{CertainCounts, ClassSplit, PixelCounts, Split, Statistics, WrongCounts};
pub use texels::{Footprint, Quantiles, TexelsPerPixel};
pub use visible::{Candidate, candidates, wrong_surfaces};
