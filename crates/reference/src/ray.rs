//! A ray in f64 against boxes and triangles, watertight.
//!
//! Woop, Benthin, Wald: *Watertight Ray/Triangle Intersection*, JCGT 2(1), 2013. Every corner is
//! sheared once per ray into a plane where the ray is a point; a shared corner is sheared to the
//! same bits in all its triangles, and the sign of an edge function of two sheared corners is
//! computed exactly, so that a ray cannot slip between two triangles of one edge.

use glam::DVec3;
use skiagraph_scene::BvhNode;

/// Corners of a triangle as the mesh holds them.
pub(crate) type Corners = [[f32; 3]; 3];

/// A ray prepared for traversal.
#[derive(Clone, Debug)]
pub(crate) struct Ray {
    origin: [f64; 3],
    inverse: [f64; 3],
    /// Axis order of the shear: the last is the direction's longest.
    axes: [usize; 3],
    /// Sx, Sy of the shear and Sz = 1 / (longest component), so that a sheared z is in units of the
    /// direction.
    pub(crate) shear: [f64; 3],
    /// By how much boxes are widened on every side.
    pad: f64,
    /// Bound on the f64 rounding of the origin along the ray: a surface met sooner is the origin's
    /// own, beyond an edge.
    pub(crate) nearest: f64,
    /// Where it ends: what is farther away is not in its way.
    pub(crate) end: f64,
}

/// Where a ray meets a triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Hit {
    /// Distance in units of the ray's direction.
    pub(crate) t: f64,
    /// Counter-clockwise as seen from the ray's origin.
    pub(crate) front: bool,
    /// Weights of the corners.
    pub(crate) weights: [f64; 3],
}

impl Ray {
    /// A ray against a scene whose corners are all within `max_distance` of `origin`; `grow` widens
    /// every box on top of the rounding errors of box and triangle tests.
    pub(crate) fn new(origin: DVec3, direction: DVec3, max_distance: f64, grow: f64) -> Self {
        let d = direction.to_array();
        let longest = direction.abs().max_position();
        let (mut first, mut second) = ((longest + 1) % 3, (longest + 2) % 3);
        if d[longest] < 0.0 {
            // Keeps the winding of the sheared triangle, and with it `Hit::front`.
            std::mem::swap(&mut first, &mut second);
        }
        // An infinite inverse would make 0 · ∞ = NaN on a box face through the origin; a huge
        // finite one cannot.
        let inverse = d.map(|c| {
            1.0 / if c.abs() < 1e-200 {
                1e-200f64.copysign(c)
            } else {
                c
            }
        });
        // Shearing errs by a few ulps of the distance to the corner, the slab test by a few of the
        // distance to the box, and `origin ± pad` by one of the origin: sixteen of the larger one
        // contain them all.
        let pad = grow + (max_distance + origin.abs().max_element()) * (16.0 * f64::EPSILON);
        Self {
            origin: origin.to_array(),
            inverse,
            axes: [first, second, longest],
            shear: [
                d[first] / d[longest],
                d[second] / d[longest],
                1.0 / d[longest],
            ],
            pad,
            // Rounding of the origin and of t, up to grazing angles where it is met four times
            // magnified.
            nearest: (max_distance + origin.abs().max_element()) * (64.0 * f64::EPSILON),
            end: f64::INFINITY,
        }
    }

    /// The same, as long as this.
    pub(crate) fn ending(self, end: f64) -> Self {
        Self { end, ..self }
    }

    /// Returns true if a surface at this distance is in the ray's way.
    pub(crate) fn reaches(&self, t: f64) -> bool {
        t > self.nearest && t < self.end
    }

    /// Where it leaves the last widened box of what it may meet.
    pub(crate) fn far_side(&self) -> f64 {
        // As `pad` contains the errors of distances, and a widened box begins sooner by as much for
        // each of its three sides.
        self.end + 4.0 * self.pad
    }

    /// Distance at which the ray slab_test the widened box, if it does so between 0 and `t_max`.
    pub(crate) fn slab_test(&self, node: &BvhNode, t_max: f64) -> Option<f64> {
        let (mut near, mut far) = (0.0, t_max);
        for axis in 0..3 {
            let low =
                (f64::from(node.min[axis]) - self.pad - self.origin[axis]) * self.inverse[axis];
            let high =
                (f64::from(node.max[axis]) + self.pad - self.origin[axis]) * self.inverse[axis];
            let (enter, leave) = if low < high { (low, high) } else { (high, low) };
            near = if enter > near { enter } else { near };
            far = if leave < far { leave } else { far };
        }
        (near <= far).then_some(near)
    }

    /// A corner in the ray's own space: x and y across the ray, z along it in units of the
    /// direction.
    pub(crate) fn sheared(&self, corner: [f32; 3]) -> DVec3 {
        self.sheared_vector(std::array::from_fn(|axis| {
            f64::from(corner[axis]) - self.origin[axis]
        }))
    }

    /// The same map for a vector.
    pub(crate) fn sheared_vector(&self, vector: [f64; 3]) -> DVec3 {
        let [x, y, z] = self.axes.map(|axis| vector[axis]);
        DVec3::new(
            x - self.shear[0] * z,
            y - self.shear[1] * z,
            self.shear[2] * z,
        )
    }

    /// Edge functions of three sheared corners, each with its exact sign; all at least 0 where the
    /// ray meets the front.
    pub(crate) fn edges([a, b, c]: [DVec3; 3]) -> [f64; 3] {
        [edge(c, b), edge(a, c), edge(b, a)]
    }

    /// The hit on a triangle, edges and corners included, at any t. A triangle seen edge-on has
    /// none.
    pub(crate) fn hit(&self, corners: &Corners) -> Option<Hit> {
        let sheared = corners.map(|corner| self.sheared(corner));
        Self::hit_sheared(sheared, Self::edges(sheared))
    }

    /// [`hit`](Self::hit) for corners and edge functions already computed.
    pub(crate) fn hit_sheared([a, b, c]: [DVec3; 3], [u, v, w]: [f64; 3]) -> Option<Hit> {
        if (u < 0.0 || v < 0.0 || w < 0.0) && (u > 0.0 || v > 0.0 || w > 0.0) {
            return None;
        }
        let determinant = u + v + w;
        if determinant == 0.0 {
            return None;
        }
        Some(Hit {
            t: (u * a.z + v * b.z + w * c.z) / determinant,
            front: determinant > 0.0,
            weights: [u, v, w].map(|edge| edge / determinant),
        })
    }
}

/// p.x · q.y − p.y · q.x with its exact sign. Rounding is monotone, so two different rounded
/// products are in the order of the exact ones; for equal ones the residuals, which a fused
/// multiply-add yields exactly, decide.
fn edge(p: DVec3, q: DVec3) -> f64 {
    let (left, right) = (p.x * q.y, p.y * q.x);
    if left != right {
        return left - right;
    }
    p.x.mul_add(q.y, -left) - p.y.mul_add(q.x, -right)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn the_sign_of_an_edge_function_survives_cancellation() {
        // (1 + ε)(1 − ε) = 1 − ε², which rounds to 1: a plain difference says 0, the exact one is
        // −ε².
        let epsilon = f64::EPSILON;
        let p = DVec3::new(1.0 + epsilon, 1.0, 0.0);
        let q = DVec3::new(1.0, 1.0 - epsilon, 0.0);
        assert!(edge(p, q) < 0.0);
        assert!(edge(q, p) > 0.0);
        assert_eq!(edge(p, p), 0.0);
    }

    #[test]
    fn winding_is_seen_along_every_axis() {
        let triangle = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0f32]];
        for turn in 0..3 {
            let turned = triangle.map(|mut corner| {
                corner.rotate_right(turn);
                corner
            });
            let mut origin = [0.25, 0.25, 2.0];
            origin.rotate_right(turn);
            let mut direction = [0.0, 0.0, -1.0];
            direction.rotate_right(turn);
            let (origin, direction) = (DVec3::from(origin), DVec3::from(direction));
            let hit = Ray::new(origin, direction, 3.0, 0.0)
                .hit(&turned)
                .expect("the ray meets the middle");
            assert_eq!(
                hit,
                Hit {
                    t: 2.0,
                    front: true,
                    weights: [0.5, 0.25, 0.25],
                }
            );
            let behind = Ray::new(
                -origin + DVec3::splat(0.5) * (DVec3::ONE - direction.abs()),
                -direction,
                3.0,
                0.0,
            );
            assert_eq!(
                behind.hit(&turned),
                Some(Hit {
                    t: 2.0,
                    front: false,
                    weights: [0.5, 0.25, 0.25],
                })
            );
        }
    }

    #[test]
    fn an_edge_on_triangle_and_a_zero_area_one_are_never_hit() {
        let ray = Ray::new(DVec3::ZERO, DVec3::Z, 3.0, 0.0);
        assert_eq!(
            ray.hit(&[[0.0, -1.0, 1.0], [0.0, 1.0, 1.0], [0.0, 0.0, 2.0]]),
            None
        );
        assert_eq!(
            ray.hit(&[[0.0, -1.0, 1.0], [0.0, 0.0, 1.0], [0.0, 1.0, 1.0]]),
            None
        );
        assert_eq!(ray.hit(&[[0.0, 0.0, 1.0]; 3]), None);
    }

    #[test]
    fn a_ray_along_a_box_face_enters_it() {
        let flat = BvhNode {
            min: [1.0, 0.0, 0.0],
            first: 0,
            max: [1.0, 2.0, 2.0],
            count: 1,
        };
        let along = |x: f64| {
            Ray::new(DVec3::new(x, 0.0, -1.0), DVec3::Z, 4.0, 0.0).slab_test(&flat, f64::INFINITY)
        };
        assert!(along(1.0).is_some());
        assert!(along(1.0 + 1e-9).is_none());
        let away = Ray::new(DVec3::new(1.0, 1.0, 3.0), DVec3::Z, 4.0, 0.0);
        assert!(away.slab_test(&flat, f64::INFINITY).is_none());
    }

    proptest! {
        /// Two triangles of one edge: a ray aimed at a point of that edge hits at least one of
        /// them.
        #[test]
        fn a_shared_edge_lets_nothing_through(
            p in prop::array::uniform3(-1.0f32..1.0),
            q in prop::array::uniform3(-1.0f32..1.0),
            along in 0.0f64..1.0,
            origin in prop::array::uniform3(-3.0f64..3.0),
            apart in 0.1f32..1.0,
        ) {
            let (vp, vq) = (glam::Vec3::from(p), glam::Vec3::from(q));
            let (start, end) = (vp.as_dvec3(), vq.as_dvec3());
            let direction = start.lerp(end, along) - DVec3::from(origin);
            let side = (end - start).cross(direction);
            prop_assume!(side.length() > 1e-3 && along > 1e-6 && along < 1.0 - 1e-6);
            let side = side.normalize().as_vec3() * apart;
            let (left, right) = (
                (vp.midpoint(vq) + side).to_array(),
                (vp.midpoint(vq) - side).to_array(),
            );
            let ray = Ray::new(DVec3::from(origin), direction, 8.0, 0.0);
            prop_assert!(ray.hit(&[p, q, left]).is_some() || ray.hit(&[q, p, right]).is_some());
        }
    }
}
