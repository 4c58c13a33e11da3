//! CPU references, in f64, of the shadow maps that classify: the geometry of casters grown, shrunk
//! and joined to their neighbours, the layers drawn of them without a rasteriser, and the status
//! that each pixel must then have.
//!
//! A CPU reference does not repeat the GPU's arithmetic; it bounds it. Each decision can be taken
//! *with leeway*: eased by what rounding and a rasteriser's snapping may move a corner (what *may*
//! cover), or made harder by it (what *surely* covers). A layer holds both, [`Map::low`] ≤ the
//! GPU's texel ≤ [`Map::high`], and a pixel whose status both leave open is *indeterminate*. On all
//! others the GPU must agree.
//!
//! Light space is measured in texels of the map: x right, y down, texel (i, j) is the closed square
//! around (i + ½, j + ½); z is depth, 0 to 1, and grows away from the light. A triangle faces the
//! light if [`TexelTriangle::area`] is negative.

pub mod arithmetic;
mod bounds;
mod casters;
pub mod exact;
mod light_space;
mod maps;
mod one_ring;
pub mod predicates;
mod preset;
mod status;
pub mod trapezoid;
mod triangle;

pub use bounds::{Bound, CLEAR_OF_EDGE, LOWEST, SLACK};
pub use casters::Casters;
pub use light_space::LightSpace;
pub use maps::{Layer, Map};
pub use one_ring::Patch;
pub use preset::{CpuReference, Cull, Depth, Method};
pub use status::{Classification, Maps};
pub use triangle::{DepthError, TexelTriangle};
