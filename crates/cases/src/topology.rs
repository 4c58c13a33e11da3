//! Defines cases of sheets whose triangles meet in ways that those of a solid do not.

use crate::case::HardCase;
use crate::shape::{Seen, Shape, seen};
use glam::DVec3;
use skiagraph_scene::generate::numbers::turn;

const LIGHT: DVec3 = DVec3::new(0.31, -1.0, 0.17);

const ROOF: [[f32; 2]; 2] = [[-0.75, -0.75], [0.75, 0.75]];

/// The camera is below the roof: it sees the shadow and not the top.
const UNDER: Seen = seen([1.3, 0.95, 2.3], [0.2, 0.0, 0.1], LIGHT);

fn under_a_roof(roof: Shape) -> Shape {
    Shape::default().floor(2.0, 0.0).and(roof)
}

/// Place and height of the sheets of `open_sheets`, and whether they face up.
const SHEETS: [([[f32; 2]; 2], f32, bool); 4] = [
    ([[-1.2, -0.9], [-0.3, 0.2]], 0.5, true),
    ([[0.1, -1.1], [0.9, -0.2]], 0.7, false),
    ([[-0.7, 0.3], [0.2, 1.0]], 0.4, false),
    ([[0.5, 0.1], [1.2, 0.8]], 0.3, true),
];

/// How far the middle of one side of `cracks` is drawn back from the other.
const CRACK: f32 = 0.04;
const SIDES: u32 = 16;

/// Points of a fan's rim, sixteen to a turn.
fn rim(step: u32, radius: f64, y: f64) -> DVec3 {
    let (x, z) = turn(f64::from(step % SIDES) / f64::from(SIDES));
    DVec3::new(x * radius, y, -z * radius)
}

pub(crate) const CASES: &[HardCase] = &[
    HardCase::open(
        "t_junctions",
        "vertices on the middle of an edge: no adjacency across it, and no gap",
        UNDER,
        || {
            let right = [-0.75, -0.25, 0.125, 0.375, 0.75];
            let roof = right.windows(2).fold(Shape::default(), |shape, z| {
                shape.sheet([[0.0, z[0]], [0.75, z[1]]], 1.0)
            });
            under_a_roof(roof.sheet([[-0.75, -0.75], [0.0, 0.75]], 1.0).reversed())
        },
    ),
    HardCase::open(
        "cracks",
        "two sheets that meet at the ends of a seam and not in its middle",
        seen([0.8, 0.7, 1.2], [0.3, 0.0, 0.17], LIGHT),
        || {
            let [near, far, deep] = [[0.0, 1.0, 0.75], [0.0, 1.0, -0.75], [CRACK, 1.0, 0.0]];
            let [right_near, right_far] = [[0.75, 1.0, 0.75], [0.75, 1.0, -0.75]];
            let roof = Shape::default()
                .sheet([[-0.75, -0.75], [0.0, 0.75]], 1.0)
                .triangles([
                    [near, right_near, deep],
                    [right_near, right_far, deep],
                    [right_far, far, deep],
                ])
                .reversed();
            Shape::default().floor(2.0, 0.0).and(roof)
        },
    ),
    HardCase::open(
        "fan_of_pages",
        "five sheets around one edge: no neighbour can be named",
        seen([2.1, 1.1, 2.2], [0.3, 0.0, 0.2], LIGHT),
        || {
            let page = |k: u8| {
                let (z, y) = turn(f64::from(k) / 5.0 + 0.07);
                let (y, z) = ((0.9 + 0.6 * y) as f32, 0.6 * z as f32);
                [[-0.8, 0.9, 0.0], [0.8, 0.9, 0.0], [0.8, y, z], [-0.8, y, z]]
            };
            let pages = (0..5).fold(Shape::default(), |shape, k| shape.quad(page(k)));
            Shape::default().floor(2.0, 0.0).and(pages)
        },
    ),
    HardCase::open(
        "fan_winds_twice",
        "a closed fan of two turns: every edge is kept, and every point is covered twice",
        seen([1.1, 0.85, 1.8], [0.0; 3], DVec3::NEG_Y),
        || {
            let fan = |row: u32, step: u32| {
                // Up for a turn and down again, so that the rim closes.
                let level = f64::from(step.min(2 * SIDES - step)) / f64::from(SIDES);
                if row == 0 {
                    DVec3::Y
                } else {
                    rim(step, 0.8, 0.9 + 0.25 * level)
                }
            };
            let fan = Shape::default().lattice(1, 2 * SIDES, fan);
            Shape::default().floor(2.0, 0.0).and(fan)
        },
    ),
    HardCase::open(
        "helicoid_in_a_texel",
        "two turns of a spiral stair around the light's direction, all of it in one texel",
        seen([0.005, 0.0105, 0.012], [0.0; 3], DVec3::NEG_Y),
        || {
            let helicoid = |row: u32, step: u32| {
                let y = 0.012 + 0.0003 * f64::from(step);
                if row == 0 {
                    DVec3::Y * y
                } else {
                    rim(step, 0.004, y)
                }
            };
            let helicoid = Shape::default().lattice(1, 2 * SIDES, helicoid);
            Shape::default().graded_slab(0.05, 3, 0.5).and(helicoid)
        },
    ),
    HardCase::open(
        "moebius_strip",
        "one side only: windings cannot agree across every edge",
        seen([1.8, 2.0, 2.4], [0.2, 0.2, 0.1], LIGHT),
        || {
            let strip = |step: u32, column: u32| {
                let ((x, z), (cos, sin)) =
                    (turn(f64::from(step) / 48.0), turn(f64::from(step) / 96.0));
                let side = 0.15 * (f64::from(column) - 2.0);
                let out = 0.8 + side * cos;
                DVec3::new(x * out, 0.8 + side * sin, -z * out)
            };
            let strip = Shape::default().lattice(48, 4, strip);
            Shape::default().floor(2.5, 0.0).and(strip)
        },
    ),
    HardCase::open(
        "open_sheets",
        "sheets that face the light and sheets that do not: culling loses half of them",
        seen([1.2, 1.9, 2.6], [0.0, 0.1, 0.0], LIGHT),
        || {
            SHEETS.iter().fold(
                Shape::default().floor(2.0, 0.0),
                |shape, &(sheet, y, up)| {
                    let sheet = Shape::default().sheet(sheet, y);
                    shape.and(if up { sheet } else { sheet.reversed() })
                },
            )
        },
    ),
    HardCase::open(
        "duplicated_triangles",
        "every triangle of a roof three times: six triangles to an inner edge",
        UNDER,
        || {
            let roof = Shape::default().sheet(ROOF, 1.0).reversed();
            under_a_roof(roof.clone().and(roof.clone()).and(roof))
        },
    ),
    HardCase::open(
        "opposite_wound",
        "a roof of two sheets, back to back in the same place",
        UNDER,
        || under_a_roof(Shape::default().sheet(ROOF, 1.0).and_reversed()),
    ),
];

#[cfg(test)]
pub(crate) mod answers {
    use super::*;
    use crate::tests::Answer;
    use crate::tests::answer::{at_height, in_disc, in_sheet, judge};

    fn roof_lit(p: DVec3) -> Option<bool> {
        judge([in_sheet(p, LIGHT, ROOF, 1.0)], 1e-3)
    }

    /// Inside the polygon of such a rim, from straight above; its sides are within a hundredth of
    /// the circle.
    fn rim_lit(p: DVec3, radius: f64, y: f64) -> Option<bool> {
        let depth = in_disc(p, DVec3::NEG_Y, [0.0, y, 0.0], 0.99 * radius);
        judge([depth], 0.0101 * radius)
    }

    /// Tells from the geometry where light arrives.
    pub(crate) const ANSWERS: &[Answer] = &[
        ("t_junctions", roof_lit),
        ("cracks", |p| {
            let crack = |met: glam::DVec2| {
                let deep = f64::from(CRACK) * (1.0 - met.y.abs() / 0.75);
                (-met.x).max(met.x - deep)
            };
            let beside = at_height(p, LIGHT, 1.0).map_or(f64::NEG_INFINITY, crack);
            judge([in_sheet(p, LIGHT, ROOF, 1.0).min(beside)], 1e-3)
        }),
        ("fan_winds_twice", |p| {
            rim_lit(p, 0.8, 0.9).filter(|_| p.y <= 0.5)
        }),
        ("helicoid_in_a_texel", |p| {
            rim_lit(p, 0.004, 0.012).filter(|_| p.y <= 1e-3)
        }),
        ("open_sheets", |p| {
            let depths = SHEETS.map(|(sheet, y, _)| in_sheet(p, LIGHT, sheet, y));
            judge(depths, 1e-3)
        }),
        ("duplicated_triangles", roof_lit),
        ("opposite_wound", roof_lit),
    ];
}
