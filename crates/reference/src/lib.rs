#![doc = include_str!("../README.md")]
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
