//! Defines cases of closed surfaces, some of which touch.

use crate::case::HardCase;
use crate::shape::{Block, LIGHT, Seen, Shape, seen};
use glam::DVec3;
use skiagraph_scene::generate::numbers::{Random, turn};

const FLOOR: Block = [[-3.0, -0.5, -3.0], [3.0, 0.0, 3.0]];

const CROSSING: [Block; 3] = [
    FLOOR,
    [[-0.9, 0.25, -0.3], [0.9, 0.65, 0.2]],
    [[-0.2, 0.0, -0.8], [0.4, 1.0, 0.7]],
];

const BOXES: Seen = seen([2.2, 2.2, 2.3], [0.5, 0.2, 0.2], LIGHT);

/// A point of the unit sphere, from its top to its bottom in `rows` and around in `columns`.
fn sphere(row: u32, rows: u32, column: u32, columns: u32) -> DVec3 {
    let (up, out) = turn(f64::from(row) / f64::from(2 * rows));
    // The poles are points, whatever the series leaves of the sine there.
    let out = if row == 0 || row == rows { 0.0 } else { out };
    let (x, z) = turn(f64::from(column % columns) / f64::from(columns));
    DVec3::new(x * out, up, -z * out)
}

const CENTRE: DVec3 = DVec3::new(0.0, 1.1, 0.0);

pub(crate) const CASES: &[HardCase] = &[
    HardCase::boxes(
        "boxes_share_a_face",
        "two boxes with one face, wound both ways, hidden between them",
        BOXES,
        &[
            FLOOR,
            [[-0.75, 0.0, -0.5], [0.0, 0.75, 0.5]],
            [[0.0, 0.0, -0.5], [0.75, 0.75, 0.5]],
        ],
    ),
    HardCase::boxes(
        "boxes_share_an_edge",
        "two boxes with one edge: four triangles around it",
        BOXES,
        &[
            FLOOR,
            [[-0.75, 0.0, -0.75], [0.0, 0.75, 0.0]],
            [[0.0, 0.0, 0.0], [0.75, 0.75, 0.75]],
        ],
    ),
    HardCase::boxes(
        "boxes_share_a_vertex",
        "two boxes with one corner: the surface pinches to a point",
        BOXES,
        &[
            FLOOR,
            [[-0.75, 0.5, -0.75], [0.0, 1.0, 0.0]],
            [[0.0, 0.0, 0.0], [0.75, 0.5, 0.75]],
        ],
    ),
    HardCase::open(
        "boxes_through_each_other",
        "a lit face of one inside the other: culling leaves an open surface",
        BOXES,
        || Shape::default().cuboids(&CROSSING),
    ),
    HardCase::closed(
        "contact_points",
        "octahedra stand on their tips: shadows begin in a point",
        seen([1.7, 1.3, 2.4], [0.2, 0.1, 0.2], LIGHT),
        || {
            let tips = (0..9u8).map(|i| [f32::from(i % 3) - 1.0, f32::from(i / 3) - 1.0]);
            tips.fold(Shape::default().cuboid(FLOOR), |shape, [x, z]| {
                let ring = [
                    [x + 0.3, 0.3, z],
                    [x, 0.3, z - 0.3],
                    [x - 0.3, 0.3, z],
                    [x, 0.3, z + 0.3],
                ];
                (0..4).fold(shape, |shape, i| {
                    let (from, to) = (ring[i], ring[(i + 1) % 4]);
                    shape
                        .triangle([from, to, [x, 0.7, z]])
                        .triangle([to, from, [x, 0.0, z]])
                })
            })
        },
    ),
    HardCase::closed(
        "torus",
        "a closed surface with a hole: it shades itself across the hole",
        seen([1.6, 2.6, 2.2], [0.2, 0.1, 0.1], LIGHT),
        || {
            let torus = |step: u32, around: u32| {
                let ((x, z), (out, up)) = (
                    turn(f64::from(step % 48) / 48.0),
                    turn(f64::from(around % 20) / 20.0),
                );
                DVec3::new(
                    x * (0.8 + 0.3 * out),
                    0.35 + 0.3 * up,
                    -z * (0.8 + 0.3 * out),
                )
            };
            Shape::default().lattice(48, 20, torus).cuboid(FLOOR)
        },
    ),
    HardCase::closed(
        "rough_potato",
        "a closed solid of random bumps: silhouettes and folds everywhere",
        seen([-0.9, 2.5, 3.6], [0.5, 0.6, 0.2], LIGHT),
        || {
            let mut random = Random::new(5);
            let radii: Vec<f64> = (0..20 * 24).map(|_| random.range(0.7, 1.0)).collect();
            let potato = |row: u32, column: u32| {
                let ring = if row.is_multiple_of(20) {
                    0
                } else {
                    24 * row + column % 24
                };
                CENTRE + sphere(row, 20, column, 24) * radii[ring as usize]
            };
            Shape::default().lattice(20, 24, potato).cuboid(FLOOR)
        },
    ),
    HardCase::closed(
        "smooth_terminator",
        "interpolated normals face the light where the triangle does not",
        seen(
            [-1.6, 2.9, 4.0],
            [0.3, 0.7, 0.1],
            DVec3::new(0.9, -1.0, 0.2),
        ),
        || {
            let smooth = |row: u32, column: u32| CENTRE + sphere(row, 12, column, 16);
            Shape::default()
                .lattice(12, 16, smooth)
                .cuboid(FLOOR)
                .smooth()
        },
    ),
    HardCase::closed(
        "fan_of_two_hundred",
        "a vertex with two hundred triangles: no walk around it ends",
        seen([1.9, 0.9, 2.1], [0.2, 0.0, 0.1], DVec3::new(0.3, -1.0, 0.2)),
        || {
            let cone = |row: u32, step: u32| {
                let (x, z) = turn(f64::from(step % 200) / 200.0);
                match row {
                    0 => DVec3::new(0.0, 1.25, 0.0),
                    1 => DVec3::new(0.8 * x, 1.0, -0.8 * z),
                    _ => DVec3::new(0.0, 1.0, 0.0),
                }
            };
            Shape::default().lattice(2, 200, cone).cuboid(FLOOR)
        },
    ),
    HardCase::closed(
        "sub_texel_triangles",
        "a sphere of twelve thousand triangles, many to a texel",
        seen([-1.6, 2.9, 4.0], [0.3, 0.7, 0.1], LIGHT),
        || {
            let fine = |row: u32, column: u32| CENTRE + sphere(row, 64, column, 96);
            Shape::default().lattice(64, 96, fine).cuboid(FLOOR)
        },
    ),
];

#[cfg(test)]
pub(crate) mod answers {
    use super::*;
    use crate::tests::Answer;
    use crate::tests::answer::{among, in_disc, judge};

    /// Tells from the geometry where light arrives.
    pub(crate) const ANSWERS: &[Answer] = &[
        ("boxes_through_each_other", |p| {
            among(p, LIGHT, &CROSSING, 1e-3)
        }),
        // The cone's own shadow lies within that of its base: it is flatter than the light.
        ("fan_of_two_hundred", |p| {
            let base = in_disc(p, DVec3::new(0.3, -1.0, 0.2), [0.0, 1.0, 0.0], 0.8);
            if p.y > 0.5 {
                Some(true)
            } else {
                judge([base], 1e-3)
            }
        }),
        ("sub_texel_triangles", |p| {
            let (way, to_light) = (CENTRE - p, -LIGHT.normalize());
            // On the sphere itself, which is convex, the side that faces the light sees it.
            let above = p.y > 1e-3;
            above
                .then_some(true)
                .or_else(|| judge([1.0 - way.reject_from_normalized(to_light).length()], 0.01))
        }),
    ];
}
