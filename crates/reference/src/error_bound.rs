//! Bounds on the f32 error of the positions of receivers (points that pixels show) and of casters
//! (triangles that may block light).

use glam::DVec3;
use skiagraph_scene::Towards;

/// Half an ulp of 1 in f32: the largest relative error of rounding a number to f32.
pub const F32_ROUNDING: f64 = 1.0 / (1u32 << 24) as f64;

/// Roundings that move a caster's corner across the ray, in units of its distance from the
/// receiver: corner − origin (1), the shear's coefficients (3: two rounded components and a
/// division), its product and sum (2), both axes together (√2).
const CASTER_ROUNDINGS: f64 = 8.0;

/// The same where the ray's direction is the difference of two rounded places, with what rounding
/// left over of one of them, made of unit length: three roundings of a component instead of one.
const POSITIONAL_CASTER_ROUNDINGS: f64 = CASTER_ROUNDINGS + 4.0;

/// Roundings that move a ray's end along it, in units of its length: those of its direction (3), of
/// the length (4) and of the distance at which a caster is met (8).
const END_ROUNDINGS: f64 = 16.0;

/// Region in which f32 arithmetic may put a receiver (the point that a pixel shows): its exact
/// position, plus −1 to 1 times each segment, plus a vector in a ball.
#[derive(Clone, Copy, Debug)]
pub struct Uncertainty {
    /// Displacements in the receiver's plane, in world space and scene units; each may act with a
    /// factor from −1 to 1. Errors of the receiver's barycentrics cause them.
    pub segments: [DVec3; 3],
    /// Radius of the ball, in scene units: the bound on all further errors of the position.
    pub radius: f64,
}

impl Uncertainty {
    /// Returns how far the segments can displace the receiver along `normal` to either side, in
    /// scene units times the length of `normal`. The ball is left out.
    pub fn along(&self, normal: DVec3) -> f64 {
        let along = |segment: &DVec3| segment.dot(normal).abs();
        self.segments.iter().map(along).sum()
    }

    /// The longest displacement of the receiver.
    pub(crate) fn reach(&self) -> f64 {
        let lengths = self.segments.iter().map(|segment| segment.length());
        lengths.sum::<f64>() + self.radius
    }

    /// Radius of a ball that holds every displacement of receiver and casters within
    /// `max_distance`.
    pub(crate) fn extent(&self, max_distance: f64, towards: &Towards) -> f64 {
        self.reach() + caster_error(max_distance, towards)
    }

    /// Bounds the f32 error of a shadow ray's end, along the ray, if it ends at its light.
    pub(crate) fn end_error(&self, towards: &Towards) -> f64 {
        if towards.distance.is_finite() {
            END_ROUNDINGS * F32_ROUNDING * towards.distance + self.reach()
        } else {
            0.0
        }
    }

    /// Displacements of the receiver towards eight sides of the light direction, each raised
    /// towards the light by the ball's radius; `caster` is the largest error of the casters in
    /// question.
    pub(crate) fn displacements(&self, to_light: DVec3, caster: f64) -> [DVec3; 8] {
        let (side, other) = to_light.any_orthonormal_pair();
        std::array::from_fn(|eighth| {
            let (sin, cos) = (eighth as f64 * std::f64::consts::FRAC_PI_4).sin_cos();
            let outwards = side * cos + other * sin;
            let turned = |&s: &DVec3| if s.dot(outwards) < 0.0 { -s } else { s };
            let in_plane: DVec3 = self.segments.iter().map(turned).sum();
            in_plane + (outwards + to_light) * (self.radius + caster)
        })
    }
}

/// Bound on the f32 displacement of a caster whose corners are within `distance` of the receiver,
/// across a shadow ray along `towards`.
pub(crate) fn caster_error(distance: f64, towards: &Towards) -> f64 {
    let roundings = if towards.distance.is_finite() {
        POSITIONAL_CASTER_ROUNDINGS
    } else {
        CASTER_ROUNDINGS
    };
    roundings * F32_ROUNDING * distance
}
