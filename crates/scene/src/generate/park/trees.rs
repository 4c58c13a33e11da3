//! Two trees of few, big triangles. The third group of views sees only their shadows.

use crate::generate::{solid::Builder, tree::Tree};
use glam::DVec3;

pub(super) fn trees(builder: &mut Builder) {
    builder.group("tree 1");
    Tree {
        foot: DVec3::new(-41.5, 0.0, -36.0),
        crown: 55.5,
        across: 32.0,
        up: 26.5,
        branches: 9,
        leaves: 466,
        leaf: (1.44, 2.72),
        seed: 7,
    }
    .grow(builder);
    builder.group("tree 2");
    Tree {
        foot: DVec3::new(20.0, 0.0, -65.0),
        crown: 29.0,
        across: 18.0,
        up: 11.0,
        branches: 9,
        leaves: 261,
        leaf: (1.5, 2.6),
        seed: 11,
    }
    .grow(builder);
}
