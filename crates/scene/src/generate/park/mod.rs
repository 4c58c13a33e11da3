//! A small park: two trees, a lamp, a flower box and a bench on a lawn, placed for the nine views
//! of `scenes/park.ron`: three of the bench, three of the flowers, three of the trees' shadows.
//!
//! Every part is a closed surface, and no two parts touch: what stands on something hovers a
//! [`GAP`](placing::GAP) above it. Methods that promise no wrong pixel promise it for such casters.

mod build;
mod flowers;
mod furniture;
mod placing;
mod trees;

pub(super) use build::build;
