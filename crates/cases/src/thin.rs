//! Defines cases with thin triangles, and triangles without an area.

use crate::case::HardCase;
use crate::shape::{Block, LIGHT, Shape, seen};
use glam::{DVec3, Vec3};
use skiagraph_scene::generate::numbers::Random;

const FLOOR: Block = [[-2.5, -0.5, -2.5], [2.5, 0.0, 2.5]];

/// Kept edges of `thin_neighbours`: x, the middle in z, and the width of what lies beyond.
fn kept_edges() -> [[f32; 3]; 24] {
    std::array::from_fn(|i| {
        let (column, row) = ((i % 12) as f32, (i / 12) as f32);
        [
            -0.66 + 0.113 * column,
            0.5 * row - 0.25,
            0.002 + 0.0008 * i as f32,
        ]
    })
}

/// Width of their chamfers.
const CHAMFER: [f32; 4] = [0.002, 0.005, 0.01, 0.02];

fn chamfered(i: usize) -> Block {
    let x = 0.6 * i as f32 - 1.2;
    [[x, 1.0, -0.7], [x + 0.3, 1.2, 0.6]]
}

const DIAGONAL: [Block; 5] = [
    [[-0.9, 0.8, -0.301], [0.9, 0.81, -0.3]],
    [[-0.9, 0.8, -0.203], [0.8, 0.81, -0.2]],
    [[-0.8, 0.8, -0.11], [0.9, 0.81, -0.1]],
    [[-0.9, 0.8, 0.0], [0.9, 0.81, 0.04]],
    [[-0.7, 0.8, 0.2], [0.9, 0.81, 0.3]],
];

const BEAM: Block = [[-0.15, 0.0, -0.15], [0.15, 4.0, 0.15]];

const SHEET: [[f32; 2]; 2] = [[-0.7, -0.6], [0.6, 0.8]];

/// Towards the light, nearly.
fn lean(corner: Vec3) -> Vec3 {
    corner - Vec3::new(0.6875, 0.0, 0.375) * corner.y
}

pub(crate) const CASES: &[HardCase] = &[
    HardCase::open(
        "thin_neighbours",
        "beyond a kept edge a sliver that ends at once: what deceives crsma",
        seen([0.4, 0.95, 1.2], [0.0, 0.0, 0.0], DVec3::NEG_Y),
        || {
            let sheets = kept_edges().map(|[x, z, width]| {
                let [far, near] = [[x, 1.0, z - 0.2], [x, 1.0, z + 0.2]];
                [
                    [far, near, [x - 0.08, 1.0, z]],
                    [near, far, [x + width, 1.0, z]],
                ]
            });
            Shape::default().floor(2.0, 0.0).triangles(sheets.concat())
        },
    ),
    HardCase::closed(
        "thin_chamfers",
        "closed bars whose lower edges are cut by less than a texel: the same on solids",
        seen([1.5, 0.9, 1.9], [0.5, 0.0, 0.4], LIGHT),
        || {
            (0..CHAMFER.len()).fold(Shape::default().cuboid(FLOOR), |shape, i| {
                let [[x0, y0, z0], [x1, y1, z1]] = chamfered(i);
                let cut = CHAMFER[i];
                let outline = [
                    [x0 + cut, y0],
                    [x1 - cut, y0],
                    [x1, y0 + 0.5 * cut],
                    [x1, y1],
                    [x0, y1],
                    [x0, y0 + 0.5 * cut],
                ];
                shape.prism(&outline, [z0, z1])
            })
        },
    ),
    HardCase::closed(
        "long_thin_diagonals",
        "triangles a thousand times as long as wide, across the map's diagonal",
        seen([1.6, 0.7, 1.6], [0.6, 0.0, 0.4], LIGHT),
        || {
            // A turn by an eighth, and larger by √2.
            let place = |[x, y, z]: [f32; 3]| [x + z, y, z - x];
            DIAGONAL
                .iter()
                .fold(Shape::default().cuboid(FLOOR), |shape, &block| {
                    shape.moved_cuboid(block, place)
                })
        },
    ),
    HardCase::open(
        "needles",
        "four hundred slivers down to a millionth of their length",
        seen([1.7, 2.2, 2.6], [0.3, 0.2, 0.2], LIGHT),
        || {
            let mut random = Random::new(3);
            let needles = (0..400).map(|i| {
                let centre = random.in_ball() * DVec3::new(1.0, 0.5, 1.0) + DVec3::Y * 0.8;
                let (along, across) = (random.direction() * 0.5, random.direction());
                let width = [2e-2, 1e-2, 3e-3, 1e-3, 1e-4, 1e-6][i % 6];
                [centre - along, centre + along, centre + across * width]
                    .map(|p| p.as_vec3().to_array())
            });
            let needles: Vec<_> = needles.collect();
            Shape::default().floor(2.5, 0.0).triangles(needles)
        },
    ),
    HardCase::open(
        "zero_area_triangles",
        "points and lines among the triangles: nothing to divide by, nothing to shade with",
        seen([1.8, 1.4, 2.6], [0.4, 0.0, 0.2], LIGHT),
        || {
            let mut random = Random::new(4);
            let mut grid = || (random.in_ball() * 64.0).round() / 64.0 + DVec3::Y * 1.2;
            let flat = (0..120).map(|i| {
                let (a, b) = (grid(), grid());
                // A point, a line and back, and a middle that is exactly between the ends.
                [[a, a, a], [a, b, b], [a, b, (a + b) * 0.5]][i % 3].map(|p| p.as_vec3().to_array())
            });
            let flat: Vec<_> = flat.collect();
            let sheet = Shape::default().sheet(SHEET, 1.0).reversed();
            Shape::default().floor(2.5, 0.0).triangles(flat).and(sheet)
        },
    ),
    HardCase::closed(
        "depths_span_the_map",
        "a beam towards the light: each of its triangles reaches from the first depth to the \
             last",
        seen([1.0, 1.0, 1.2], [0.2, 0.1, 0.1], LIGHT),
        || {
            Shape::default()
                .cuboid(FLOOR)
                .moved_cuboid(BEAM, |corner| lean(Vec3::from(corner)).to_array())
        },
    ),
];

#[cfg(test)]
pub(crate) mod answers {
    use super::*;
    use crate::tests::Answer;
    use crate::tests::answer::{among, at_height, in_block, in_sheet, judge};

    /// Tells from the geometry where light arrives.
    pub(crate) const ANSWERS: &[Answer] = &[
        ("thin_neighbours", |p| {
            let met = at_height(p, DVec3::NEG_Y, 1.0)?;
            let kites = kept_edges().map(|kite| {
                let [x, z, width] = kite.map(f64::from);
                let left = 1.0 - (met.y - z).abs() / 0.2;
                (width * left - (met.x - x)).min(met.x - x + 0.08 * left)
            });
            judge(kites, 5e-4)
        }),
        ("thin_chamfers", |p| {
            let depths = (0..CHAMFER.len()).filter_map(|i| in_block(p, LIGHT, chamfered(i)));
            judge(depths, 0.05)
        }),
        ("long_thin_diagonals", |p| {
            let turned = |v: DVec3| DVec3::new((v.x - v.z) * 0.5, v.y, (v.x + v.z) * 0.5);
            among(turned(p), turned(LIGHT), &DIAGONAL, 1e-3)
        }),
        ("zero_area_triangles", |p| {
            judge([in_sheet(p, LIGHT, SHEET, 1.0)], 1e-3)
        }),
        // Upright again, it is a box; the floor stays where it is.
        ("depths_span_the_map", |p| {
            let upright = |v: DVec3| v + DVec3::new(0.6875, 0.0, 0.375) * v.y;
            among(upright(p), upright(LIGHT), &[BEAM], 1e-3)
        }),
    ];
}
