//! A small park: two trees, a lamp, a flower box and a bench on a lawn, placed for the nine views
//! of `scenes/park.ron`: three of the bench, three of the flowers, three of the trees' shadows.
//!
//! Every part is a closed surface, and no two parts touch: what stands on something hovers a
//! [`GAP`](crate::generate::solid::GAP) above it. Methods that promise no wrong pixel promise it
//! for such casters.

mod flowers;
mod furniture;
mod trees;

use super::solid::Builder;
use crate::mesh::Mesh;
use flowers::flower_box;
use furniture::{bench, lamp};
use glam::DVec3;
use trees::trees;

/// Builds the park: about 55,000 triangles.
pub(super) fn build() -> Mesh {
    let mut builder = Builder::default();
    builder.group("lawn");
    lawn(&mut builder);
    bench(&mut builder);
    lamp(&mut builder);
    flower_box(&mut builder);
    trees(&mut builder);
    builder.finish()
}

/// A slab whose upper side is y = 0, as large as what the nine views see of it at 16:9, and a
/// little more.
fn lawn(builder: &mut Builder) {
    let [low, high] = [[-90.0, -2.0, -125.0], [160.0, 0.0, 165.0]].map(DVec3::from);
    builder.slab(low, high, 24);
}
