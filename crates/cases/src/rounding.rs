//! Defines cases with gaps, extents and positions at which f32 runs out of digits.

use crate::case::{Edges, HardCase};
use crate::shape::{Block, LIGHT, Seen, Shape, seen};

/// Four slabs, each smaller than the one below and `gap` above it; their tops are at multiples of a
/// quarter.
fn stack(gap: f32) -> [Block; 4] {
    std::array::from_fn(|i| {
        let (half, top) = (1.6 - 0.4 * i as f32, 1.0 + 0.25 * i as f32);
        let bottom = if i == 0 { 0.5 } else { top - 0.25 + gap };
        [[-half, bottom, -half], [half, top, half]]
    })
}

const fn stacked(name: &'static str, reason: &'static str, shape: fn() -> Shape) -> HardCase {
    HardCase::closed(
        name,
        reason,
        seen([2.5, 4.1, 2.9], [0.5, 1.1, 0.3], LIGHT),
        shape,
    )
}

/// Unit in the last place of numbers from 1 to 2.
const ULP: f32 = f32::EPSILON;

const LID: [[f32; 2]; 2] = [[-1.0, -0.8], [0.9, 1.1]];

/// A floor under a lid that the camera sees through, because it is wound downward.
fn lid(scale: f32, gap: f32) -> Shape {
    let lid = LID.map(|corner| corner.map(|c| c * scale));
    let lid = Shape::default().sheet(lid, gap).reversed();
    Shape::default().floor(2.0 * scale, 0.0).and(lid)
}

const fn lid_seen(scale: f32) -> Seen {
    let by = scale as f64;
    seen(
        [1.1 * by, 3.3 * by, 1.7 * by],
        [0.2 * by, 0.0, 0.1 * by],
        LIGHT,
    )
}

const SHEETS: [[f32; 2]; 2] = [[-0.8, -0.7], [0.7, 0.9]];

const FAR_OFF: f32 = 1e7;
/// On a plain of a million units.
const DETAIL: [Block; 3] = [
    [[-0.01, 0.0, -0.01], [0.0, 0.01, 0.0]],
    [[0.004, 0.0, 0.003], [0.014, 0.006, 0.013]],
    [[-2e5, 0.0, 2e5], [-1e5, 1e5, 3e5]],
];
const CRUMBS: [Block; 3] = [
    [[-0.05, 0.0, -0.04], [0.0, 0.05, 0.02]],
    [[0.03, 0.0, 0.03], [0.05, 0.02, 0.06]],
    [[-8.0, 0.0, 5.0], [-5.0, 8.0, 8.0]],
];

pub(crate) const CASES: &[HardCase] = &[
    stacked(
        "stack_gap_one_ulp",
        "closed slabs an ulp above one another: no bias fits in between",
        || Shape::default().cuboids(&stack(ULP)),
    ),
    stacked(
        "stack_gap_1e_6",
        "closed slabs a millionth above one another",
        || Shape::default().cuboids(&stack(1e-6)),
    ),
    stacked(
        "stack_gap_1e_3",
        "closed slabs a thousandth above one another",
        || Shape::default().cuboids(&stack(1e-3)),
    ),
    HardCase::open(
        "lid_gap_1e_3",
        "receivers close below a sheet, seen through its back: every bias lights them",
        lid_seen(1.0),
        || lid(1.0, 1e-3),
    ),
    HardCase::open(
        "lid_gap_2e_5",
        "the same at ten times what f32 loses",
        lid_seen(1.0),
        || lid(1.0, 2e-5),
    ),
    HardCase::open(
        "lid_gap_1e_6",
        "the same in a scene of a twentieth: the gap counts in extents",
        lid_seen(0.05),
        || lid(0.05, 1e-6),
    ),
    HardCase::open(
        "sheets_an_ulp_apart",
        "casters of both windings, coplanar or an ulp apart, fight for the map",
        seen([1.9, 0.9, 2.8], [0.6, 0.0, 0.3], LIGHT),
        || {
            let sheets = (0..5u8).fold(Shape::default(), |shape, i| {
                let sheet = Shape::default().sheet(SHEETS, 1.0 + f32::from(i / 2) * ULP);
                shape.and(if i % 2 == 0 { sheet } else { sheet.reversed() })
            });
            Shape::default().floor(2.5, 0.0).and(sheets)
        },
    ),
    HardCase::boxes(
        "scale_1e_4",
        "the unit is a ten-thousandth: constants in scene units are too large",
        seen([2.2e-4, 2.6e-4, 3e-4], [4e-5, 2e-5, 2e-5], LIGHT),
        &[
            [[-4e-4, -5e-5, -4e-4], [4e-4, 0.0, 4e-4]],
            [[-5e-5, 0.0, -5e-5], [5e-5, 1e-4, 5e-5]],
        ],
    ),
    HardCase::boxes(
        "origin_offset_1e7",
        "ten million units from the origin, where f32 counts in ones",
        seen(
            [10_003_000.0, 10_004_000.0, 10_005_000.0],
            [10_000_300.0, 10_000_200.0, 10_000_100.0],
            LIGHT,
        ),
        &[
            [
                [FAR_OFF - 4000.0, FAR_OFF - 500.0, FAR_OFF - 4000.0],
                [FAR_OFF + 4000.0, FAR_OFF, FAR_OFF + 4000.0],
            ],
            [
                [FAR_OFF - 500.0, FAR_OFF, FAR_OFF - 700.0],
                [FAR_OFF + 600.0, FAR_OFF + 1000.0, FAR_OFF + 500.0],
            ],
        ],
    )
    // A receiver is off by its position's five roundings of a distance of √3 offsets, and by those
    // of its weights, the more the flatter it is seen: by some 22 units, as pictures of 1024²
    // pixels have it, too. The eye is 6,763 units away, and the picture 45 degrees high.
    .indeterminate_along(Edges {
        offset: FAR_OFF,
        roundings: 22.0,
        length: 0.73,
        height: 5_600.0,
    }),
    HardCase::closed(
        "extent_1e6_detail_1e_2",
        "boxes of a hundredth on a plain of a million: all of them in one texel",
        seen([0.03, 0.04, 0.05], [0.004, 0.002, 0.003], LIGHT),
        || Shape::default().graded_slab(0.05, 12, 1e5).cuboids(&DETAIL),
    ),
    HardCase::closed(
        "huge_beside_tiny",
        "crumbs on a floor of two triangles four hundred times their size",
        seen([0.13, 0.2, 0.21], [0.03, 0.01, 0.02], LIGHT),
        || {
            Shape::default()
                .cuboid([[-10.0, -1.0, -10.0], [10.0, 0.0, 10.0]])
                .cuboids(&CRUMBS)
        },
    ),
];

#[cfg(test)]
pub(crate) mod answers {
    use super::*;
    use crate::tests::Answer;
    use crate::tests::answer::{among, in_sheet, judge};
    use glam::DVec3;

    fn lid_lit(p: DVec3, scale: f32, gap: f32) -> Option<bool> {
        let lid = LID.map(|corner| corner.map(|c| c * scale));
        judge([in_sheet(p, LIGHT, lid, gap)], 1e-4 * f64::from(scale))
    }

    /// Tells from the geometry where light arrives.
    pub(crate) const ANSWERS: &[Answer] = &[
        ("stack_gap_one_ulp", |p| among(p, LIGHT, &stack(ULP), 1e-3)),
        ("stack_gap_1e_6", |p| among(p, LIGHT, &stack(1e-6), 1e-3)),
        ("stack_gap_1e_3", |p| among(p, LIGHT, &stack(1e-3), 1e-3)),
        ("lid_gap_1e_3", |p| lid_lit(p, 1.0, 1e-3)),
        ("lid_gap_2e_5", |p| lid_lit(p, 1.0, 2e-5)),
        ("lid_gap_1e_6", |p| lid_lit(p, 0.05, 1e-6)),
        ("sheets_an_ulp_apart", |p| {
            judge([in_sheet(p, LIGHT, SHEETS, 1.0)], 1e-3)
        }),
        ("extent_1e6_detail_1e_2", |p| among(p, LIGHT, &DETAIL, 1e-5)),
        ("huge_beside_tiny", |p| among(p, LIGHT, &CRUMBS, 1e-3)),
    ];
}
