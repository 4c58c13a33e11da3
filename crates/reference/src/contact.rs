//! Decides if a shadow ray's answer is indeterminate: if it flips when receiver or casters move
//! within their f32 error bounds.
//!
//! A caster is *touched* when some admissible displacement of the receiver, or of the caster's
//! corners, makes the shadow ray hit it, and *robust* when every one does. A lit pixel that touches
//! no caster and a shadowed one with a robust caster are determinate. A shadowed pixel without one,
//! whose ray meets an edge between two casters, is determinate if displaced rays find it in shadow
//! all around; but two triangles that merely abut, without a common edge, move each on its own, and
//! a ray between them is indeterminate.

use crate::error_bound::{Uncertainty, caster_error};
use crate::ray::{Corners, Ray};
use crate::tree::Caster;
use glam::DVec3;
use skiagraph_scene::Towards;
use skiagraph_scene::mask::Asked;

/// Relation of a shadow ray to a caster.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Contact {
    /// No displacement makes it a hit.
    Miss,
    /// No hit, but some displacement makes it one.
    Touched,
    /// A hit that some displacement undoes.
    Hit {
        /// The caster's own error, scene units.
        error: f64,
        /// Some displacement puts the ray across an edge that no other triangle has.
        near_open_edge: bool,
    },
    /// A hit under every displacement.
    Robust,
}

impl Contact {
    /// The same of a masked caster. Where its mask flips within the error it may be there or not,
    /// as across an open edge.
    fn masked(self, asked: Asked, error: f64) -> Self {
        match (asked.flips, asked.opaque) {
            (false, true) => self,
            (false, false) => Self::Miss,
            (true, true) if self != Self::Touched => Self::Hit {
                error,
                near_open_edge: true,
            },
            (true, _) => Self::Touched,
        }
    }
}

/// A shadow ray with its uncertainty, in the ray's sheared space.
pub(crate) struct FuzzyRay<'a> {
    ray: &'a Ray,
    origin: DVec3,
    towards: Towards,
    uncertainty: &'a Uncertainty,
    sheared_segments: [DVec3; 3],
    /// Bound on the displacement of the ray's end.
    end_error: f64,
}

impl<'a> FuzzyRay<'a> {
    /// `towards` is what `ray` was made of.
    pub(crate) fn new(
        ray: &'a Ray,
        origin: DVec3,
        towards: Towards,
        uncertainty: &'a Uncertainty,
    ) -> Self {
        let sheared = |segment: DVec3| ray.sheared_vector(segment.to_array());
        let sheared_segments = uncertainty.segments.map(sheared);
        Self {
            ray,
            origin,
            towards,
            uncertainty,
            sheared_segments,
            end_error: uncertainty.end_error(&towards),
        }
    }

    /// Classifies one caster.
    pub(crate) fn contact(&self, caster: &Caster<'_>) -> Contact {
        let &Caster {
            corners,
            open,
            ref masked,
            ..
        } = caster;
        let sheared = corners.map(|corner| self.ray.sheared(corner));
        let [a, b, c] = sheared;
        let [sx, sy, _] = self.ray.shear;
        // |S| ≤ 1 twice, so a ball's image is within √3 of its radius, and so is a sheared corner
        // of the corner itself.
        let farthest = corners
            .map(|corner| (glam::Vec3::from(corner).as_dvec3() - self.origin).length_squared());
        let farthest = farthest[0].max(farthest[1]).max(farthest[2]).sqrt();
        let error = caster_error(farthest, &self.towards);
        let ball = self.uncertainty.radius + error;
        let segments = self.sheared_segments.iter();
        let extent =
            segments.fold(DVec3::ZERO, |sum, s| sum + s.abs()) + DVec3::splat(ball * 3f64.sqrt());
        let (low, high) = (a.min(b).min(c), a.max(b).max(c));
        if low.x > extent.x
            || low.y > extent.y
            || high.x < -extent.x
            || high.y < -extent.y
            || high.z < -extent.z
            || low.z > self.ray.end + self.end_error + extent.z
        {
            return Contact::Miss;
        }
        if corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0] {
            // Two equal corners stay equal in any arithmetic, and the edge functions cancel
            // exactly.
            return Contact::Miss;
        }

        let edges = Ray::edges(sheared);
        let sides = [c - b, a - c, b - a];
        let thresholds: [f64; 3] = std::array::from_fn(|i| {
            let side = sides[i];
            let across = |s: &DVec3| (side.x * s.y - side.y * s.x).abs();
            let segments: f64 = self.sheared_segments.iter().map(across).sum();
            segments
                + ball
                    * (side.x * side.x + side.y * side.y + (side.y * sx - side.x * sy).powi(2))
                        .sqrt()
        });
        let (t, t_error) = self.distance(&corners, ball);
        let inside =
            |sign: f64, margin: f64| (0..3).all(|i| sign * edges[i] >= margin * thresholds[i]);
        let (end, end_error) = (self.ray.end, self.end_error + t_error);
        let contact = match Ray::hit_sheared(sheared, edges).filter(|hit| self.ray.reaches(hit.t)) {
            Some(_)
                if t > t_error
                    && (end == f64::INFINITY || t < end - end_error)
                    && (inside(1.0, 1.0) || inside(-1.0, 1.0)) =>
            {
                Contact::Robust
            }
            Some(_) => {
                // A ray that may as well end before the caster passes all around it, too.
                let near_end = end != f64::INFINITY && t > end - end_error;
                let near_open = |i: usize| open[i] && edges[i].abs() < thresholds[i];
                let near_open_edge = near_end || (0..3).any(near_open);
                Contact::Hit {
                    error,
                    near_open_edge,
                }
            }
            None if t > -t_error
                && t < end + end_error
                && (inside(1.0, -1.0) || inside(-1.0, -1.0)) =>
            {
                Contact::Touched
            }
            None => Contact::Miss,
        };
        let asked = masked.as_ref().filter(|_| contact != Contact::Miss);
        asked.map_or(contact, |masked| {
            contact.masked(masked.ask(edges, thresholds), error)
        })
    }

    /// Distance to the caster's plane and how much displacements change it: without bound for a
    /// plane along the ray.
    fn distance(&self, corners: &Corners, ball: f64) -> (f64, f64) {
        let [a, b, c] = corners.map(|corner| glam::Vec3::from(corner).as_dvec3());
        let normal = (b - a).cross(c - a);
        let slope = normal.dot(self.towards.direction);
        if slope == 0.0 {
            return (0.0, f64::INFINITY);
        }
        let error = (self.uncertainty.along(normal) + ball * normal.length()) / slope.abs();
        (normal.dot(a - self.origin) / slope, error)
    }
}
