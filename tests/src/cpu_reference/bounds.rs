//! How much is allowed for rounding, and on which side.

use super::predicates;

/// Half of what a texel is taken larger than it is, per axis, for all rounding (δ):
/// shaders/shared/light_triangle.wgsl.
pub const SLACK: f64 = predicates::SLACK as f64;

/// Corners nearer to an edge's line than this, in texels, are on no side of it.
pub const CLEAR_OF_EDGE: f64 = predicates::CLEAR_OF_EDGE as f64;

/// Triangles lower than this, in texels, have no plane to speak of.
pub const LOWEST: f64 = 0.125;

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
