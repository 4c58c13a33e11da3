//! Simple scenes whose answer is known.

use super::{Casters, HardCase, build::Shape};
use glam::DVec3;

pub(super) const CASES: &[HardCase] = &[HardCase {
    name: "box_on_floor",
    reason: "contact: a closed box stands on the floor that it shades",
    casters: Casters::Closed,
    band_cap: 0.01,
    build: || {
        Shape::default()
            .cuboid([-4.0, -0.5, -4.0], [4.0, 0.0, 4.0])
            .cuboid([-0.5, 0.0, -0.5], [0.5, 1.0, 0.5])
            .scene(
                "box_on_floor",
                DVec3::new(3.0, 4.0, 5.0),
                DVec3::ZERO,
                DVec3::new(1.0, -1.0, 0.0),
            )
    },
    // On the floor the shadow is 0.5 < x < 1.5, |z| < 0.5; whatever else faces this light is lit.
    lit: Some(|p| {
        if p.y > 1e-3 || p.y < -1e-3 {
            return Some(true);
        }
        let inside = (p.x - 0.5).min(1.5 - p.x).min(0.5 - p.z.abs());
        (inside.abs() > 1e-3).then_some(inside < 0.0)
    }),
}];
