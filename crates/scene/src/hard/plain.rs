//! Simple scenes, and scenes of next to nothing.

use super::{
    Casters, HardCase, Shows,
    answer::among,
    build::{Block, Shape},
};
use glam::DVec3;

const BOX: [Block; 2] = [
    [[-4.0, -0.5, -4.0], [4.0, 0.0, 4.0]],
    [[-0.5, 0.0, -0.5], [0.5, 1.0, 0.5]],
];
const ROOM: [Block; 3] = [
    [[-4.0, -0.5, -4.0], [4.0, 0.0, 4.0]],
    [[1.5, 0.0, 1.5], [3.5, 4.0, 3.5]],
    [[-1.0, 0.0, -0.7], [0.0, 0.7, 0.3]],
];
const ROOM_LIGHT: DVec3 = DVec3::new(-1.0, -1.5, -0.9);
const NEAR: [Block; 4] = [
    [[-4.0, -0.5, -4.0], [4.0, 0.0, 4.0]],
    [[-0.4, 0.0, -0.6], [0.3, 0.8, 0.4]],
    [[1.3, 2.4, 1.5], [2.3, 2.8, 2.4]],
    [[3.0, 4.0, 3.0], [4.0, 5.0, 4.2]],
];
const NEAR_LIGHT: DVec3 = DVec3::new(-1.0, -1.6, -1.2);

pub(super) const CASES: &[HardCase] = &[
    HardCase {
        build: || {
            Shape::default().cuboids(&BOX).scene(
                [2.7, 1.8, 1.5],
                [0.9, 0.1, 0.0],
                DVec3::new(1.0, -1.0, 0.0),
            )
        },
        lit: Some(|p| among(p, DVec3::new(1.0, -1.0, 0.0), &BOX, 1e-3)),
        ..HardCase::new(
            "box_on_floor",
            "contact: a closed box stands on the floor that it shades",
            Casters::Closed,
        )
    },
    HardCase {
        shows: Shows::Nothing,
        build: || Shape::default().scene([0.0, 1.0, 3.0], [0.0; 3], DVec3::new(0.3, -1.0, 0.2)),
        ..HardCase::new(
            "empty_scene",
            "no triangle: no fit, no hierarchy, empty buffers",
            Casters::Closed,
        )
    },
    HardCase {
        shows: Shows::LitOnly,
        build: || {
            Shape::default()
                .triangle([[-1.0, 0.1, 1.0], [1.2, -0.2, 0.8], [0.1, 0.3, -1.1]])
                .scene([0.3, 2.0, 1.0], [0.0; 3], DVec3::new(0.3, -1.0, 0.2))
        },
        lit: Some(|_| Some(true)),
        ..HardCase::new(
            "one_triangle",
            "its own receiver, its own caster, the whole map",
            Casters::Open,
        )
    },
    HardCase {
        shows: Shows::LitOnly,
        build: || {
            Shape::default()
                .quad([
                    [-1.0, 0.0, 1.0],
                    [1.0, 0.0, 1.0],
                    [1.0, 1.0, -1.0],
                    [-1.0, 1.0, -1.0],
                ])
                .scene([0.4, 2.2, 1.9], [0.0, 0.5, 0.0], DVec3::new(0.3, -1.0, 0.2))
        },
        lit: Some(|_| Some(true)),
        ..HardCase::new(
            "one_quad",
            "two triangles in one plane, each beside the other's receivers",
            Casters::Open,
        )
    },
    HardCase {
        shows: Shows::Nothing,
        build: || {
            Shape::default().cuboids(&BOX).scene(
                [1.0, 4.0, 2.0],
                [0.0; 3],
                DVec3::new(0.1, 1.0, 0.05),
            )
        },
        ..HardCase::new(
            "everything_faces_away",
            "no pixel faces the light: no ray, and shares of nothing",
            Casters::Closed,
        )
    },
    HardCase {
        build: || {
            Shape::default()
                .cuboids(&ROOM)
                .scene([2.5, 1.9, 2.4], [-0.9, 0.0, -0.6], ROOM_LIGHT)
        },
        lit: Some(|p| among(p, ROOM_LIGHT, &ROOM, 1e-3)),
        ..HardCase::new(
            "camera_inside",
            "the eye is inside a closed box, whose faces it does not see and whose shadow it does",
            Casters::Closed,
        )
    },
    HardCase {
        build: || {
            let mut scene = Shape::default().cuboids(&NEAR).scene(
                [3.5, 4.5, 3.6],
                [-0.4, 0.0, -0.4],
                NEAR_LIGHT,
            );
            scene.views[0].near = 5.0;
            scene
        },
        lit: Some(|p| among(p, NEAR_LIGHT, &NEAR, 1e-3)),
        ..HardCase::new(
            "before_the_near_plane",
            "casters between the eye and the near plane, and around the eye: not drawn, and still in the light",
            Casters::Closed,
        )
    },
];
