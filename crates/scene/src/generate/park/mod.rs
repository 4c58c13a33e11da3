//! A small park after the dissertation's Bench, Flowers and Trees scenes (tables 1 to 3): two trees, a lamp, a flower box and
//! a bench on a lawn, placed so that the nine views see what its figures 34 to 36 show.
//!
//! Every part is a closed surface, and no two parts touch: what stands on something hovers a [`GAP`] above it. Methods that
//! promise no wrong pixel promise it for such casters.

mod flowers;
mod furniture;
mod trees;

use super::solid::{Builder, Frame};
use crate::Mesh;
use glam::DVec3;

/// Free space between two parts that would touch in a real park; far below a pixel in every view.
const GAP: f64 = 0.02;

/// How bench and planter are turned, as a fraction of a full turn: their long sides lie across the light, but 10° off, so that
/// no side face lies along it. There n · l and the shadows of neighbours would hang on the last bits.
const ACROSS_THE_LIGHT: f64 = 0.18;

/// Builds the park: about 55,000 triangles.
pub(super) fn build() -> Mesh {
    let mut builder = Builder::default();
    builder.group("lawn");
    lawn(&mut builder);
    furniture::bench(&mut builder);
    furniture::lamp(&mut builder);
    flowers::flower_box(&mut builder);
    trees::trees(&mut builder);
    builder.finish()
}

/// A slab whose upper side is y = 0, as large as what the nine views see of it at 16:9, and a little more.
fn lawn(builder: &mut Builder) {
    builder.slab(
        DVec3::new(-90.0, -2.0, -125.0),
        DVec3::new(160.0, 0.0, 165.0),
        24,
    );
}
