//! Defines cases in which the light is parallel, or nearly so, to surfaces.

use crate::case::HardCase;
use crate::shape::{Shape, seen};
use glam::DVec3;

const GRAZING: DVec3 = DVec3::new(1.0, -0.02, 0.13);
const WALL_LIGHT: DVec3 = DVec3::new(1.0, -1.0, 0.0);
const SEAM_LIGHT: DVec3 = DVec3::new(0.0, -1.0, 0.13);
const UP: DVec3 = DVec3::new(0.5, 1.0, 0.3);

/// Turn of the facets of `facing_by_an_ulp` out of the light, around x: the first three are within
/// f32's rounding of it.
const TURNS: [f32; 16] = [
    0.0, 6e-8, -6e-8, 2e-6, 4e-6, 1e-5, 1e-4, 1e-3, -2e-6, -1e-5, 1e-2, 2e-5, 3e-6, 3e-4, -1e-3,
    3e-2,
];

pub(crate) const CASES: &[HardCase] = &[
    HardCase::boxes(
        "grazing_light",
        "light a degree above the floor: a hair of depth is a long shadow",
        seen([1.0, 2.6, 4.0], [-1.0, 0.0, 0.0], GRAZING),
        &[
            [[-4.0, -0.5, -4.0], [4.0, 0.0, 4.0]],
            [[-3.0, 0.0, -1.5], [-2.8, 0.03, -0.5]],
            [[-2.5, 0.0, -0.1], [-2.3, 0.05, 0.5]],
            [[-1.0, 0.0, 0.9], [-0.9, 0.02, 1.3]],
        ],
    ),
    HardCase::open(
        "facing_by_an_ulp",
        "facets whose N·L is 0, an ulp, and powers of ten above and below",
        seen([0.0, 0.1, 4.0], [0.0; 3], DVec3::NEG_Y),
        || {
            let facets = TURNS.iter().enumerate().map(|(i, turn)| {
                let x = i as f32 * 0.25 - 2.0;
                [
                    [x, -1.0, *turn],
                    [x + 0.24, -1.0, *turn],
                    [x + 0.12, 1.0, -turn],
                ]
            });
            Shape::default().triangles(facets)
        },
    )
    // The facet of one ulp, one of eleven that face the light, is indeterminate by what it is.
    .indeterminate_up_to(0.12),
    HardCase::boxes(
        "light_along_an_axis",
        "light along -y: every upright face is a line in the map",
        seen([1.6, 2.1, 2.6], [0.1, 0.2, 0.1], DVec3::NEG_Y),
        &[
            [[-2.0, -0.5, -2.0], [2.0, 0.0, 2.0]],
            [[-0.75, 0.75, -0.75], [0.75, 0.875, 0.75]],
            [[-0.5, 0.0, -0.5], [-0.375, 0.75, -0.375]],
            [[0.5, 0.0, -0.5], [0.625, 0.75, -0.375]],
            [[-0.125, 0.0, 0.5], [0.0, 0.75, 0.625]],
        ],
    ),
    HardCase::boxes(
        "light_along_a_wall",
        "light in the plane of a wall, which ends in its own shadow's edge",
        seen([1.6, 2.0, 3.2], [0.3, 0.2, 0.0], WALL_LIGHT),
        &[
            [[-3.0, -0.5, -3.0], [3.0, 0.0, 3.0]],
            [[-1.0, 0.0, -0.5], [1.0, 1.0, 0.0]],
            [[-2.0, 0.0, 0.0], [-1.5, 0.75, 0.5]],
        ],
    ),
    HardCase::closed(
        "light_nearly_along_a_wall",
        "N·L of a ten-thousandth all over the picture",
        seen([0.4, 0.3, 3.0], [0.0, 0.0, 0.5], WALL_LIGHT),
        || {
            // Its face towards +z leans to the light by a ten-thousandth.
            let lean = |[x, y, z]: [f32; 3]| [x, y, if z > 0.0 { 0.5 + 1e-4 * (x - y) } else { z }];
            Shape::default().moved_cuboid([[-1.0, -1.0, -0.5], [1.0, 1.0, 0.5]], lean)
        },
    )
    // Along the diagonal the other half of the wall may stand before its neighbour, by f32: the
    // rounding over the slope is wide.
    .indeterminate_up_to(0.035),
    HardCase::boxes(
        "light_travels_upwards",
        "a ceiling lit from below: nothing may take down for away from the light",
        seen([1.5, -3.0, 3.0], [0.1, 0.0, 0.0], UP),
        &[
            [[-3.0, 0.0, -3.0], [3.0, 0.5, 3.0]],
            [[-0.6, -0.9, -0.5], [0.5, 0.0, 0.4]],
            [[0.9, -1.6, -1.5], [1.7, -1.3, -0.6]],
        ],
    ),
    HardCase::open(
        "no_depth_at_all",
        "a flat scene across the light: the map's depths span nothing",
        seen([0.7, 2.3, 1.1], [0.0, 0.3, 0.0], DVec3::NEG_Y),
        || Shape::default().floor(1.0, 0.3),
    ),
    HardCase::open(
        "edge_on_triangles",
        "fins along the light: in the map they have no area, and they shade nothing",
        seen([0.9, 3.2, 2.2], [0.0; 3], DVec3::NEG_Y),
        || {
            let fins = (0..24u8).map(|i| {
                let (x, z) = (
                    f32::from(i % 6) * 0.5 - 1.25,
                    f32::from(i / 6) * 0.625 - 1.0,
                );
                let lean = if i % 2 == 0 { 0.0 } else { 0.375 };
                [
                    [x, 0.2, z],
                    [x + 0.5, 0.25, z + lean],
                    [x + 0.25, 1.0, z + 0.5 * lean],
                ]
            });
            Shape::default().floor(2.0, 0.0).triangles(fins)
        },
    ),
    HardCase::open(
        "light_along_a_seam",
        "eye, light and the inner edges of a roof in one plane: with an odd width, a column \
             of rays meets nothing but edges",
        seen([0.0, 0.9, 1.8], [0.0, 0.0, 0.1], SEAM_LIGHT),
        || {
            // The floor is one triangle, its own mirror image: receivers of the middle column are
            // at x = 0 exactly.
            let roof = (0..16u8).fold(Shape::default(), |shape, i| {
                let z = f32::from(i) * 0.25 - 2.0;
                shape
                    .sheet([[-0.5, z], [0.0, z + 0.25]], 1.0)
                    .sheet([[0.0, z], [0.5, z + 0.25]], 1.0)
            });
            Shape::default()
                .triangle([[0.0, 0.0, -6.0], [-5.0, 0.0, 2.0], [5.0, 0.0, 2.0]])
                .and(roof.reversed())
        },
    ),
];

#[cfg(test)]
pub(crate) mod answers {
    use super::*;
    use crate::tests::Answer;
    use crate::tests::answer::{in_sheet, judge};

    /// Tells from the geometry where light arrives.
    pub(crate) const ANSWERS: &[Answer] = &[
        ("facing_by_an_ulp", |_| Some(true)),
        ("light_nearly_along_a_wall", |_| Some(true)),
        ("no_depth_at_all", |_| Some(true)),
        ("edge_on_triangles", |_| Some(true)),
        ("light_along_a_seam", |p| {
            let depth = in_sheet(p, SEAM_LIGHT, [[-0.5, -2.0], [0.5, 2.0]], 1.0);
            judge([depth], 1e-3)
        }),
    ];
}
