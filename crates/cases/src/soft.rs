//! Defines cases that filtered shadow maps get wrong.

use crate::case::HardCase;
use crate::shape::{Block, seen};
use glam::DVec3;

const OBLIQUE: DVec3 = DVec3::new(1.0, -1.0, 0.1);
/// A floor, a plate above it, and one six times as high whose shadow ends in the middle of the
/// lower one's.
const TWO_OCCLUDERS: [Block; 3] = [
    [[-3.0, -0.5, -2.5], [3.0, 0.0, 2.5]],
    [[-2.0, 1.0, -1.0], [0.0, 1.05, 1.0]],
    [[-8.0, 6.0, -2.0], [-6.0, 6.05, 1.5]],
];

const ACROSS: DVec3 = DVec3::new(0.2, -1.0, 0.9);

const STEEP: DVec3 = DVec3::new(0.3, -1.0, 0.1);

pub(crate) const CASES: &[HardCase] = &[
    HardCase::boxes(
        "two_occluders",
        "a silhouette within another's shadow: the variance of depths lets light through",
        seen([3.6, 2.2, 2.4], [0.1, 0.0, 0.0], OBLIQUE),
        &TWO_OCCLUDERS,
    ),
    HardCase::boxes(
        "three_occluders",
        "two silhouettes side by side within a shadow: more depths than four moments tell",
        seen([3.6, 2.2, 2.4], [0.1, 0.0, 0.0], OBLIQUE),
        // A floor, a plate just above it, and two high ones whose shadows end side by side within
        // the low one's.
        &[
            TWO_OCCLUDERS[0],
            [[-1.3, 0.3, -1.0], [0.7, 0.35, 1.0]],
            [[-5.0, 3.0, -1.8], [-2.37, 3.05, 1.6]],
            [[-8.0, 6.0, -2.0], [-5.45, 6.05, 1.5]],
        ],
    ),
    HardCase::boxes(
        "contact",
        "a thin wall on its own shadow: receivers near it are as deep as their caster, almost",
        seen([0.5, 1.2, 2.0], [0.0, 0.0, 0.3], ACROSS),
        &[
            [[-5.0, -0.5, -5.0], [5.0, 0.0, 5.0]],
            [[-1.0, 0.0, -0.01], [1.0, 0.8, 0.01]],
        ],
    ),
    HardCase::boxes(
        "near_and_far",
        "plates near the floor and far above: a lamp would blur the shadow of one alone",
        seen([0.0, 2.4, 3.0], [0.0, 0.0, 0.0], STEEP),
        // Their shadows lie side by side.
        &[
            [[-2.5, -0.5, -2.0], [2.5, 0.0, 2.0]],
            [[-1.43, 0.1, -0.61], [-0.23, 0.12, 0.59]],
            [[-0.7, 3.0, -0.9], [0.5, 3.02, 0.3]],
        ],
    ),
];
