//! A level as games have them: a building of four storeys whose floors and walls are sheets of few
//! large triangles, with doorways, shafts, and slits below the ceilings. Its depth is much larger
//! than its number of triangles: what a map costs by its texels shows here.
//!
//! Every part is open: nothing in it is a solid.

use super::{numbers::Random, solid::Builder};
use crate::{mesh::Mesh, weld::Welder};
use glam::DVec3;
use std::ops::Range;

const STOREYS: u32 = 4;
/// Rooms along each side of a storey, and their width and height.
const ROOMS: u32 = 6;
const ROOM: f64 = 10.0;
const HEIGHT: f64 = 4.0;
/// The doorway in each wall, along it, and its height.
const DOORWAY: Range<f64> = 4.0..5.5;
const LINTEL: f64 = 2.5;
/// Between a wall and the ceiling.
const SLIT: f64 = 0.2;
/// How wide the shaft beside a floor is, where there is one.
const SHAFT: f64 = 1.5;

/// Sheets that share the corners that they have in common.
#[derive(Default)]
struct Sheets {
    builder: Builder,
    positions: Welder,
}

impl Sheets {
    /// A rectangle from a corner, counter-clockwise from `u` to `v`.
    fn rectangle(&mut self, corner: DVec3, u: DVec3, v: DVec3) {
        let normal = u.cross(v).normalize().as_vec3();
        let normal = self.builder.normals.index(normal);
        let corners = [corner, corner + u, corner + u + v, corner + v];
        let [a, b, c, d] = corners.map(|corner| self.positions.index(corner.as_vec3()));
        let mesh = &mut self.builder.mesh;
        mesh.triangles.extend([[a, b, c], [a, c, d]]);
        mesh.normal_indices.extend([[normal; 3]; 2]);
        self.builder.end_group();
    }

    /// A wall from a corner on the floor, with its doorway.
    fn wall(&mut self, corner: DVec3, along: DVec3) {
        let columns = [0.0..DOORWAY.start, DOORWAY, DOORWAY.end..ROOM];
        let rows = [0.0..LINTEL, LINTEL..HEIGHT - SLIT];
        for (column, row) in [(0, 0), (0, 1), (1, 1), (2, 0), (2, 1)] {
            let (column, row) = (&columns[column], &rows[row]);
            self.rectangle(
                corner + along * column.start + DVec3::Y * row.start,
                along * (column.end - column.start),
                DVec3::Y * (row.end - row.start),
            );
        }
    }
}

/// Builds the level: 3,168 triangles.
pub(super) fn build() -> Mesh {
    let mut random = Random::new(2009);
    let mut sheets = Sheets::default();
    for storey in 0..STOREYS {
        let corner = |x: u32, z: u32| {
            DVec3::new(f64::from(x), 0.0, f64::from(z)) * ROOM
                + DVec3::Y * (f64::from(storey) * HEIGHT)
        };
        let rooms = || (0..ROOMS).flat_map(|x| (0..ROOMS).map(move |z| corner(x, z)));
        sheets.builder.group(&format!("floor_{storey}"));
        for corner in rooms() {
            // The ground is whole.
            let has_shaft = random.range(0.0, 1.0) < 0.33 && storey > 0;
            let shaft = if has_shaft { SHAFT } else { 0.0 };
            let [x, z] = [DVec3::X * (ROOM - shaft), DVec3::Z * ROOM];
            sheets.rectangle(corner + DVec3::X * shaft, z, x);
        }
        sheets.builder.group(&format!("walls_{storey}"));
        for corner in rooms() {
            sheets.wall(corner, DVec3::X);
            sheets.wall(corner, DVec3::Z);
        }
    }
    sheets.builder.mesh.positions = sheets.positions.values;
    sheets.builder.finish()
}
