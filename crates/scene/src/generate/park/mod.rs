//! A small park after the dissertation's Bench, Flowers and Trees scenes (tables 1 to 3): two
//! trees, a lamp, a flower box and a bench on a lawn, placed so that the nine views see what its
//! figures 34 to 36 show.
//!
//! Every part is a closed surface, and no two parts touch: what stands on something hovers a
//! [`GAP`](placing::GAP) above it. Methods that promise no wrong pixel promise it for such casters.

mod build;
mod flowers;
mod furniture;
mod placing;
mod trees;

pub(super) use build::build;
