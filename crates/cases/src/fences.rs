//! Defines cases of casters with gaps between them, both narrower than a texel.

use crate::case::HardCase;
use crate::shape::{Block, LIGHT, Shape, seen};

const FLOOR: Block = [[-2.5, -0.5, -2.5], [2.5, 0.0, 2.5]];

/// Poles four thousandths apart on a floor of 6.4 units: a map of 1024 texels has texels of sixteen
/// times a pole's width.
fn poles() -> [Block; 25] {
    std::array::from_fn(|i| {
        let x = (i as f32 - 12.0) * 0.004;
        [[x, 0.0, -0.0002], [x + 0.0004, 0.05, 0.0002]]
    })
}

fn slats() -> [Block; 25] {
    std::array::from_fn(|i| {
        let z = (i as f32 - 12.0) * 0.06;
        [[-0.9, 0.8, z], [0.9, 0.81, z + 0.03]]
    })
}

const CELLS: usize = 15;

fn is_filled(x: usize, z: usize) -> bool {
    x < CELLS && z < CELLS && !(x % 2 == 1 && z % 2 == 1)
}

fn cell(x: usize, z: usize) -> Block {
    let at = |i: usize| (i as f32 - 7.5) * 0.1;
    [[at(x), 1.0, at(z)], [at(x + 1), 1.05, at(z + 1)]]
}

fn cells() -> impl Iterator<Item = (usize, usize)> {
    (0..CELLS)
        .flat_map(|x| (0..CELLS).map(move |z| (x, z)))
        .filter(|&(x, z)| is_filled(x, z))
}

/// A plate with a hole in every other cell of every other row, as one closed surface.
fn plate() -> Shape {
    cells().fold(Shape::default(), |shape, (x, z)| {
        let [low, high] = cell(x, z);
        let [[x0, y0, z0], [x1, y1, z1]] = [low, high];
        let mut shape = shape
            .sheet([[x0, z0], [x1, z1]], y1)
            .and(Shape::default().sheet([[x0, z0], [x1, z1]], y0).reversed());
        let sides = [
            (is_filled(x + 1, z), [x1, z1], [x1, z0]),
            (x > 0 && is_filled(x - 1, z), [x0, z0], [x0, z1]),
            (is_filled(x, z + 1), [x0, z1], [x1, z1]),
            (z > 0 && is_filled(x, z - 1), [x1, z0], [x0, z0]),
        ];
        for (_, [ax, az], [bx, bz]) in sides.into_iter().filter(|side| !side.0) {
            shape = shape.quad([[ax, y0, az], [bx, y0, bz], [bx, y1, bz], [ax, y1, az]]);
        }
        shape
    })
}

pub(crate) const CASES: &[HardCase] = &[
    HardCase::closed(
        "poles",
        "a fence of poles thinner than a tenth of a texel",
        seen([0.012, 0.03, 0.05], [0.008, 0.0, 0.007], LIGHT),
        || Shape::default().graded_slab(0.05, 3, 0.5).cuboids(&poles()),
    ),
    HardCase::closed(
        "slats",
        "as much gap as slat, both near a texel's width",
        seen([1.7, 0.7, 1.9], [0.6, 0.0, 0.3], LIGHT),
        || Shape::default().cuboid(FLOOR).cuboids(&slats()),
    ),
    HardCase::closed(
        "grid_of_holes",
        "a plate with a hole in every fourth cell: light spots of a few texels",
        seen([1.5, 0.9, 1.6], [0.8, 0.0, 0.4], LIGHT),
        || Shape::default().cuboid(FLOOR).and(plate()),
    ),
];

#[cfg(test)]
pub(crate) mod answers {
    use super::*;
    use crate::tests::Answer;
    use crate::tests::answer::{among, in_block, judge};

    /// Tells from the geometry where light arrives.
    pub(crate) const ANSWERS: &[Answer] = &[
        ("poles", |p| among(p, LIGHT, &poles(), 2e-5)),
        ("slats", |p| among(p, LIGHT, &slats(), 1e-3)),
        ("grid_of_holes", |p| {
            let depths = cells().filter_map(|(x, z)| in_block(p, LIGHT, cell(x, z)));
            judge(depths, 1e-3).filter(|_| p.y <= 0.5)
        }),
    ];
}
