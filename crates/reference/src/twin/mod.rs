//! CPU twins, in f64, of the shadow maps that classify: the geometry of grown, shrunk and joined casters, the layers drawn of them
//! without a rasteriser, and the status that each pixel must then have.
//!
//! A twin does not repeat the GPU's arithmetic; it bounds it. Each decision can be taken *with leeway*: eased by what rounding and a rasteriser's
//! snapping may move a corner (what *may* cover), or made harder by it (what *surely* covers). A layer holds both, [`Map::low`] ≤ the GPU's
//! texel ≤ [`Map::high`], and a pixel whose status both do not settle is *in band*. Outside the band the GPU must agree.
//!
//! Light space is measured in texels of the map: x right, y down, texel (i, j) is the closed square around (i + ½, j + ½); z is depth, 0 to 1,
//! and grows away from the light. A triangle faces the light if [`TexelTriangle::area`] is negative.

mod casters;
pub mod exact;
mod geometry;
mod light_space;
mod maps;
mod ring;
mod status;

pub use casters::Casters;
pub use geometry::{DepthError, TexelTriangle};
pub use light_space::LightSpace;
pub use maps::{Layer, Map};
pub use ring::Patch;
pub use status::{Classification, Maps};

/// Half of what a texel is taken larger than it is, per axis, for all rounding (δ): shaders/shared/light_triangle.wgsl.
pub const SLACK: f64 = crate::predicates::SLACK as f64;

/// Corners nearer to an edge's line than this, in texels, are on no side of it.
pub const CLEAR_OF_EDGE: f64 = crate::predicates::CLEAR_OF_EDGE as f64;

/// Triangles lower than this, in texels, have no plane to speak of.
pub const LOWEST: f64 = 0.125;

/// A hybrid whose shadow map classifies; named as its preset.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    /// The four texels of a bilinear lookup agree (Beister, Ernst, Stamminger 2005).
    HybridPcf,
    /// Grown against shrunk casters (Hertel, Hormann, Westermann 2009).
    Crsm,
    /// Grown casters against those that shrink only where their surface ends.
    Crsma,
    /// Grown casters against texels that a caster's one-ring covers.
    CrsmaFull,
}

/// Faces that are not in the map.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Cull {
    /// All are in it.
    None,
    /// Those that face the light are not.
    Front,
    /// Those that face away from the light are not.
    Back,
}

/// Which depth of a triangle a texel holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Depth {
    /// The triangle's plane at the texel's centre.
    Plane,
    /// A bound over the whole texel: nearest in the grown layer, farthest in the other.
    Conservative,
}

/// Which end of what arithmetic may yield.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Bound {
    /// Whatever may cover covers, at its least depth.
    Low,
    /// Only what surely covers does, at its greatest depth.
    High,
}

impl Bound {
    /// `amount` as leeway for a condition of coverage: positive eases it, negative makes it harder.
    pub(crate) fn leeway(self, amount: f64) -> f64 {
        match self {
            Self::Low => amount,
            Self::High => -amount,
        }
    }
}

/// The twin of a preset with its params.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Twin {
    /// Which preset.
    pub method: Method,
    /// Edge of the map in texels, at least 1.
    pub map_size: u32,
    /// Faces that cast no shadow.
    pub cull: Cull,
    /// Triangles grow and shrink by this many diagonals of a texel; no affair of [`Method::HybridPcf`].
    pub n: f64,
    /// Which depth; [`Method::HybridPcf`] always takes the plane's.
    pub depth: Depth,
}
