//! Meshes of which triangles have equal, evenly spaced or ever larger boxes: each takes as long as
//! any other mesh of as many triangles. With passes that merge one pair each, any of these takes
//! minutes.

use crate::bvh::{checked, checked_levels, mesh, pieces, runs};
use glam::Vec3;
use skiagraph_scene::TwoLevelBvh;
use std::f32::consts::TAU;

/// Triangles of each mesh.
const COUNT: usize = 60_000;

type Triangles = Vec<[Vec3; 3]>;

/// A level square of half this `size`.
fn sheet(centre: Vec3, size: f32) -> Triangles {
    let corner = |x: f32, z: f32| centre + Vec3::new(x, 0.0, z) * size;
    let [a, b, c, d] = [
        corner(-1.0, -1.0),
        corner(-1.0, 1.0),
        corner(1.0, 1.0),
        corner(1.0, -1.0),
    ];
    vec![[a, b, c], [a, c, d]]
}

fn block(low: Vec3, size: Vec3) -> Triangles {
    let corner = |index: usize| {
        let far = [1, 2, 4].map(|bit| if index & bit == 0 { 0.0 } else { 1.0 });
        low + Vec3::from(far) * size
    };
    let sides = [
        [0, 1, 3, 2],
        [4, 6, 7, 5],
        [0, 4, 5, 1],
        [2, 3, 7, 6],
        [0, 2, 6, 4],
        [1, 5, 7, 3],
    ];
    let cut = |side: [usize; 4]| {
        let [a, b, c, d] = side.map(corner);
        [[a, b, c], [a, c, d]]
    };
    sides.into_iter().flat_map(cut).collect()
}

fn many(each: usize, part: impl Fn(usize) -> Triangles) -> Triangles {
    (0..COUNT / each).flat_map(part).collect()
}

/// A point on a circle that `COUNT` points divide.
fn rim(index: usize) -> Vec3 {
    let (sin, cos) = (index as f32 / COUNT as f32 * TAU).sin_cos();
    Vec3::new(cos, 0.0, sin)
}

fn meshes() -> [(&'static str, Triangles); 9] {
    let y = |index: usize| Vec3::Y * index as f32;
    let far = Vec3::splat(1e6);
    [
        ("coincident", many(2, |_| sheet(Vec3::ONE, 2.0))),
        ("sheets", many(2, |index| sheet(y(index) * 1e-4, 2.0))),
        (
            "sheets far from the origin",
            many(2, |index| sheet(far + y(index) * 1e-4, 2.0)),
        ),
        (
            "louvres far from the origin",
            many(2, |index| sheet(far + y(index), 2.0)),
        ),
        (
            "stairs",
            many(12, |index| {
                let step = Vec3::new(0.0, 0.2, 0.3);
                block(step * index as f32, step.with_x(2.0))
            }),
        ),
        (
            "fence",
            many(12, |index| {
                block(Vec3::X * index as f32 * 0.2, Vec3::new(0.1, 2.0, 0.02))
            }),
        ),
        (
            "grid",
            many(12, |index| {
                let [row, column] = [index / 70, index % 70].map(|at| at as f32);
                block(far + Vec3::new(row, 0.0, column) * 2.0, Vec3::ONE)
            }),
        ),
        (
            "terraces, each a little larger than the one above",
            many(2, |index| {
                sheet(y(index) * -0.01, 1.0 + index as f32 * 0.01)
            }),
        ),
        (
            "one face of many corners",
            many(1, |index| vec![[rim(0), rim(index + 1), rim(index + 2)]]),
        ),
    ]
}

#[test]
fn meshes_of_equal_boxes_have_whole_trees_at_once() {
    for (name, triangles) in meshes() {
        println!("{name}");
        checked(&mesh(&triangles));
    }
}

#[test]
fn hierarchies_of_pieces_that_stand_alike_are_whole() {
    for (name, triangles) in meshes() {
        let mesh = mesh(&triangles);
        // One piece for every 12 triangles, as instances are, and of three large ones.
        for count in [mesh.triangles.len() / 12, 3] {
            let run = runs(mesh.triangles.len(), count);
            let levels = TwoLevelBvh::build(&mesh, &mesh, &pieces(&run), usize::MAX);
            println!("{name}, {count} pieces");
            checked_levels(&mesh, &levels);
        }
    }
}
