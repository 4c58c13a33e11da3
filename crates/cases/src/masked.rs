//! Defines cases with alpha masks, which cut holes into triangles.

use crate::case::HardCase;
use crate::shape::{Seen, Shape, seen};
use glam::{DVec3, Vec2, Vec3};
use skiagraph_scene::{Mask, Material, Scene, Wrap};
use std::sync::Arc;

const DOWN: DVec3 = DVec3::NEG_Y;
const SLANTED: DVec3 = DVec3::new(0.6, -1.0, 0.25);

/// Half the edge of the masked sheets.
const HALF: f32 = 0.7;

/// Texels along an edge of `mask_edges`.
const CHECKERS: u32 = 8;

/// Gives all triangles above `y` a mask, its texture coordinates by their place.
fn put_mask(scene: &mut Scene, y: f32, mask: Mask, uv: impl Fn(Vec3) -> Vec2) {
    let mesh = &mut scene.mesh;
    mesh.surfaces.uvs = mesh.positions.iter().map(|&place| uv(place)).collect();
    mesh.surfaces.uv_indices.clone_from(&mesh.triangles);
    mesh.surfaces.materials = vec![
        Material::default(),
        Material {
            mask: Some(Arc::new(mask)),
            double_sided: true,
            ..Material::default()
        },
    ];
    let above = |triangle: &[u32; 3]| {
        let corners = triangle.iter();
        corners.fold(f32::MIN, |top, &index| {
            top.max(mesh.positions[index as usize].y)
        }) > y
    };
    let materials = mesh.triangles.iter().map(|tri| u32::from(above(tri)));
    mesh.surfaces.of = materials.collect();
}

/// From 0 to 1 over a sheet.
fn across(place: Vec3) -> Vec2 {
    (Vec2::new(place.x, place.z) / HALF + 1.0) * 0.5
}

fn checkers(edge: u32, wrap: [Wrap; 2]) -> Mask {
    Mask::new([edge; 2], wrap, |x, y| (x + y).is_multiple_of(2))
}

fn sheet(y: f32) -> Shape {
    Shape::default()
        .floor(2.0, 0.0)
        .sheet([[-HALF; 2], [HALF; 2]], y)
}

const SEEN: Seen = seen([0.5, 1.6, 2.2], [0.0, 0.2, 0.0], SLANTED);

pub(crate) const CASES: &[HardCase] = &[
    HardCase::open(
        "mask_edges",
        "a sheet of opaque and open texels like a chessboard: every edge of a shadow is a texel's",
        seen([0.5, 1.6, 2.2], [0.0, 0.2, 0.0], DOWN),
        || sheet(1.0),
    )
    .changed(|scene| {
        let mask = checkers(CHECKERS, [Wrap::Clamp; 2]);
        put_mask(scene, 0.5, mask, across)
    }),
    HardCase::open(
        "mask_wraps",
        "a mask that repeats, is mirrored and ends within its sheet, turned against it",
        SEEN,
        || sheet(0.8),
    )
    .changed(|scene| {
        let mask = Mask::new([5, 7], [Wrap::Mirror, Wrap::Clamp], |x, y| (x * y) % 3 != 1);
        let turn = Vec2::from_angle(0.3);
        put_mask(scene, 0.5, mask, |place| {
            turn.rotate(across(place)) * 4.0 - 1.7
        })
    }),
    HardCase::open(
        "mask_fine",
        "texels of a mask that are smaller than the pixels of its shadow",
        SEEN,
        || sheet(1.0),
    )
    .changed(|scene| {
        let mask = checkers(256, [Wrap::Repeat; 2]);
        put_mask(scene, 0.5, mask, |place| across(place) * 1.37)
    }),
    HardCase::open(
        "mask_far_uvs",
        "texture coordinates far from the origin, where f32 has few steps within a texel",
        SEEN,
        || sheet(0.6),
    )
    .changed(|scene| {
        let mask = checkers(16, [Wrap::Repeat; 2]);
        put_mask(scene, 0.5, mask, |place| across(place) + 1000.0)
    })
    // A sixteenth of a unit is a texel, and f32 has 16,384 steps between 1,000 and 1,001.
    .indeterminate_up_to(0.04),
    HardCase::open(
        "mask_behind_mask",
        "masked sheets close above each other: behind an open texel there is the next sheet",
        SEEN,
        || {
            (0..4).fold(sheet(1.0), |shape, i| {
                shape.sheet([[-HALF; 2], [HALF; 2]], 0.98 - 0.01 * i as f32)
            })
        },
    )
    .changed(|scene| {
        let mask = checkers(9, [Wrap::Repeat; 2]);
        put_mask(scene, 0.5, mask, |place| across(place) + place.y * 7.0)
    }),
    HardCase::open(
        "mask_through_floor",
        "masked leaves that stand in the floor: their shadows begin at open and at opaque texels",
        SEEN,
        || {
            let leaves = (0..7).map(|i| {
                let x = 0.2 * i as f32 - 0.6;
                [[x, -0.2, -0.5], [x + 0.05, -0.2, 0.5], [x + 0.3, 0.7, 0.0]]
            });
            Shape::default().floor(2.0, 0.0).triangles(leaves)
        },
    )
    .changed(|scene| {
        let mask = checkers(12, [Wrap::Repeat; 2]);
        put_mask(scene, 0.01, mask, |place| Vec2::new(place.z, place.y))
    }),
];

#[cfg(test)]
pub(crate) mod answers {
    use super::*;
    use crate::tests::Answer;
    use crate::tests::answer::at_height;
    use glam::DVec2;

    /// Tells from the geometry where light arrives.
    pub(crate) const ANSWERS: &[Answer] = &[("mask_edges", |p| {
        let met = at_height(p, DOWN, 1.0)?;
        let half = f64::from(HALF);
        let texel = (met / half + 1.0) * (0.5 * f64::from(CHECKERS));
        // The nearest edge of any texel, in texels.
        if (texel - texel.round()).abs().min_element() < 1e-3 {
            return None;
        }
        let outside = met.abs().max_element() > half;
        let DVec2 { x, y } = texel.floor();
        Some(outside || (x + y).rem_euclid(2.0) != 0.0)
    })];
}
