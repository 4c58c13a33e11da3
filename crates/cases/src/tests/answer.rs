//! Finds from the geometry if light reaches a point. Its measure is the depth of the ray from the
//! point to the light inside a caster; it is negative if the ray misses the caster by so much.

use crate::shape::Block;
use glam::{DVec2, DVec3};

/// Returns true if the greatest of `depths`, the depths of the ray to the light inside each caster,
/// is negative: the point is lit. `None` if it is within `margin` of 0.
pub(crate) fn judge(depths: impl IntoIterator<Item = f64>, margin: f64) -> Option<bool> {
    let deepest = depths.into_iter().fold(f64::NEG_INFINITY, f64::max);
    (deepest.abs() > margin).then_some(deepest < 0.0)
}

/// Returns true if light that travels along `light` reaches a point of a surface that faces it,
/// past the boxes `blocks`; `None` within `margin` of a shadow's edge. A box does not shade points
/// of its own surface.
pub(crate) fn among(point: DVec3, light: DVec3, blocks: &[Block], margin: f64) -> Option<bool> {
    let inside = |&block: &Block| in_block(point, light, block);
    judge(blocks.iter().filter_map(inside), margin)
}

/// Does the same as [`among`] for a light at the position `place`; boxes beyond it cast no shadow.
pub(crate) fn among_at(point: DVec3, place: DVec3, blocks: &[Block], margin: f64) -> Option<bool> {
    let way = place - point;
    let inside = |&block: &Block| in_block_before(point, way.normalize(), way.length(), block);
    judge(blocks.iter().filter_map(inside), margin)
}

/// Returns the depth (scene units, negative for a miss) inside a box of the ray from a point to a
/// light that travels along `light`; `None` for a point on the box's surface.
pub(crate) fn in_block(point: DVec3, light: DVec3, block: Block) -> Option<f64> {
    in_block_before(point, -light.normalize(), f64::INFINITY, block)
}

/// Inside a box on the way of this length from the point along a unit vector.
fn in_block_before(point: DVec3, to_light: DVec3, end: f64, block: Block) -> Option<f64> {
    let [low, high] = block.map(|corner| glam::Vec3::from(corner).as_dvec3());
    let beside = (point - low).min(high - point).min_element();
    if beside.abs() <= 1e-12 * (low.abs().max(high.abs()).max_element() + point.length()) {
        return None;
    }
    let (mut enter, mut leave, mut within) = (f64::NEG_INFINITY, f64::INFINITY, f64::INFINITY);
    for axis in 0..3 {
        let (near, far) = (low[axis] - point[axis], high[axis] - point[axis]);
        if to_light[axis] == 0.0 {
            within = within.min(far.min(-near));
        } else {
            let (a, b) = (near / to_light[axis], far / to_light[axis]);
            (enter, leave) = (enter.max(a.min(b)), leave.min(a.max(b)));
        }
    }
    Some((leave - enter).min(leave).min(within).min(end - enter))
}

/// Returns x and z at which the ray from a point to a light that travels along `light` passes the
/// height `y`; `None` if it does not.
pub(crate) fn at_height(point: DVec3, light: DVec3, y: f64) -> Option<DVec2> {
    let t = (y - point.y) / -light.y;
    let met = point - light * t;
    // A point of the plane itself is no further from it than rounding.
    (t * light.length() > 1e-9).then_some(DVec2::new(met.x, met.z))
}

/// Returns the depth (scene units, negative for a miss) inside a horizontal rectangle, given by two
/// corners of x and z, at height `y` of the ray from a point to a light that travels along `light`;
/// −∞ if the ray does not pass that height.
pub(crate) fn in_sheet(point: DVec3, light: DVec3, sheet: [[f32; 2]; 2], y: f32) -> f64 {
    let [low, high] = sheet.map(|corner| glam::Vec2::from(corner).as_dvec2());
    let inside = |met: DVec2| (met - low).min(high - met).min_element();
    at_height(point, light, f64::from(y)).map_or(f64::NEG_INFINITY, inside)
}

/// Returns the depth (scene units, negative for a miss) inside a horizontal disc around `[x, y, z]`
/// of the ray from a point to a light that travels along `light`; −∞ if the ray does not pass its
/// height.
pub(crate) fn in_disc(point: DVec3, light: DVec3, [x, y, z]: [f64; 3], radius: f64) -> f64 {
    let inside = |met: DVec2| radius - met.distance(DVec2::new(x, z));
    at_height(point, light, y).map_or(f64::NEG_INFINITY, inside)
}

/// Returns the depth (scene units, negative for a miss) inside a triangle of the ray from a point
/// to a light that travels along `light`; −∞ if the ray does not pass its plane.
pub(crate) fn in_triangle(point: DVec3, light: DVec3, corners: [[f32; 3]; 3]) -> f64 {
    let [a, b, c] = corners.map(|corner| glam::Vec3::from(corner).as_dvec3());
    let normal = (b - a).cross(c - a);
    let t = normal.dot(point - a) / normal.dot(light);
    // A point of the plane itself is no further from it than rounding.
    if t * light.length() <= 1e-9 || t.is_nan() {
        return f64::NEG_INFINITY;
    }
    let met = point - light * t;
    let inward = normal.normalize();
    [(a, b), (b, c), (c, a)]
        .map(|(from, to)| inward.dot((to - from).normalize().cross(met - from)))
        .into_iter()
        .fold(f64::INFINITY, f64::min)
}
