//! The whole park.

use super::{
    flowers::flower_box,
    furniture::{bench, lamp},
    trees::trees,
};
use crate::{generate::solid::Builder, mesh::Mesh};
use glam::DVec3;

/// Builds the park: about 55,000 triangles.
pub(crate) fn build() -> Mesh {
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
    builder.slab(
        DVec3::new(-90.0, -2.0, -125.0),
        DVec3::new(160.0, 0.0, 165.0),
        24,
    );
}
