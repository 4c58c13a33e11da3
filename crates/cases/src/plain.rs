//! Defines simple cases, and cases with few triangles or none.

use crate::case::HardCase;
use crate::shape::{Block, Shape, seen};
use glam::DVec3;

const BOX: [Block; 2] = [
    [[-4.0, -0.5, -4.0], [4.0, 0.0, 4.0]],
    [[-0.5, 0.0, -0.5], [0.5, 1.0, 0.5]],
];
const ROOM_LIGHT: DVec3 = DVec3::new(-1.0, -1.5, -0.9);
const NEAR_LIGHT: DVec3 = DVec3::new(-1.0, -1.6, -1.2);

pub(crate) const CASES: &[HardCase] = &[
    HardCase::boxes(
        "box_on_floor",
        "contact: a closed box stands on the floor that it shades",
        seen([2.7, 1.8, 1.5], [0.9, 0.1, 0.0], DVec3::new(1.0, -1.0, 0.0)),
        &BOX,
    ),
    HardCase::closed(
        "empty_scene",
        "no triangle: no fit, no hierarchy, empty buffers",
        seen([0.0, 1.0, 3.0], [0.0; 3], DVec3::new(0.3, -1.0, 0.2)),
        Shape::default,
    ),
    HardCase::open(
        "one_triangle",
        "its own receiver, its own caster, the whole map",
        seen([0.3, 2.0, 1.0], [0.0; 3], DVec3::new(0.3, -1.0, 0.2)),
        || Shape::default().triangle([[-1.0, 0.1, 1.0], [1.2, -0.2, 0.8], [0.1, 0.3, -1.1]]),
    ),
    HardCase::open(
        "one_quad",
        "two triangles in one plane, each beside the other's receivers",
        seen([0.4, 2.2, 1.9], [0.0, 0.5, 0.0], DVec3::new(0.3, -1.0, 0.2)),
        || {
            Shape::default().quad([
                [-1.0, 0.0, 1.0],
                [1.0, 0.0, 1.0],
                [1.0, 1.0, -1.0],
                [-1.0, 1.0, -1.0],
            ])
        },
    ),
    HardCase::closed(
        "everything_faces_away",
        "no pixel faces the light: no ray, and shares of nothing",
        seen([1.0, 4.0, 2.0], [0.0; 3], DVec3::new(0.1, 1.0, 0.05)),
        || Shape::default().cuboids(&BOX),
    ),
    HardCase::boxes(
        "camera_inside",
        "the eye is inside a closed box, whose faces it does not see and whose shadow it does",
        seen([2.5, 1.9, 2.4], [-0.9, 0.0, -0.6], ROOM_LIGHT),
        &[
            [[-4.0, -0.5, -4.0], [4.0, 0.0, 4.0]],
            [[1.5, 0.0, 1.5], [3.5, 4.0, 3.5]],
            [[-1.0, 0.0, -0.7], [0.0, 0.7, 0.3]],
        ],
    ),
    HardCase::boxes(
        "before_the_near_plane",
        "casters between the eye and the near plane, and around the eye: not drawn, and still \
             in the light",
        seen([3.5, 4.5, 3.6], [-0.4, 0.0, -0.4], NEAR_LIGHT),
        &[
            [[-4.0, -0.5, -4.0], [4.0, 0.0, 4.0]],
            [[-0.4, 0.0, -0.6], [0.3, 0.8, 0.4]],
            [[1.3, 2.4, 1.5], [2.3, 2.8, 2.4]],
            [[3.0, 4.0, 3.0], [4.0, 5.0, 4.2]],
        ],
    )
    .changed(|scene| scene.views[0].near = 5.0),
];

#[cfg(test)]
pub(crate) mod answers {
    use crate::tests::Answer;

    /// Tells from the geometry where light arrives.
    pub(crate) const ANSWERS: &[Answer] = &[
        ("one_triangle", |_| Some(true)),
        ("one_quad", |_| Some(true)),
    ];
}
