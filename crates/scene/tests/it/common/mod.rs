//! A plain f64 ray caster over the library's own hierarchy.

use glam::{DVec3, Vec3};
use skiagraph_scene::{Bvh, Mesh};

/// A crossing of a ray with a triangle.
#[derive(Clone, Copy)]
pub struct Hit {
    /// Distance in lengths of the direction.
    pub t: f64,
    /// The triangle.
    pub primitive: u32,
    /// True if the triangle was met from behind.
    pub back: bool,
    u: f64,
    v: f64,
}

impl Hit {
    /// Interpolated vertex normal, not normalised.
    pub fn normal(&self, mesh: &Mesh) -> DVec3 {
        let [a, b, c] = mesh.corner_normals(self.primitive);
        a * (1.0 - self.u - self.v) + b * self.u + c * self.v
    }
}

/// Calls `visit` for the triangles that the ray crosses, in no order, until it returns false;
/// whether it never did.
pub fn cast(
    mesh: &Mesh,
    bvh: &Bvh,
    origin: DVec3,
    direction: DVec3,
    mut visit: impl FnMut(Hit) -> bool,
) -> bool {
    let inverse = direction.recip();
    let mut open = vec![0];
    while let Some(index) = open.pop() {
        let node = bvh.nodes[index as usize];
        let low = (Vec3::from(node.min).as_dvec3() - origin) * inverse;
        let high = (Vec3::from(node.max).as_dvec3() - origin) * inverse;
        if low.min(high).max_element().max(0.0) > low.max(high).min_element() * (1.0 + 1e-12) {
            continue;
        }
        if node.count == 0 {
            open.extend([node.first, node.first + 1]);
            continue;
        }
        for &primitive in &bvh.primitives[node.first as usize..(node.first + node.count) as usize] {
            if cross(mesh, primitive, origin, direction).is_some_and(|hit| !visit(hit)) {
                return false;
            }
        }
    }
    true
}

/// The nearest front face.
pub fn nearest(mesh: &Mesh, bvh: &Bvh, origin: DVec3, direction: DVec3) -> Option<Hit> {
    let mut nearest: Option<Hit> = None;
    cast(mesh, bvh, origin, direction, |hit| {
        if !hit.back && nearest.is_none_or(|n| hit.t < n.t) {
            nearest = Some(hit);
        }
        true
    });
    nearest
}

/// Möller and Trumbore 1997.
fn cross(mesh: &Mesh, primitive: u32, origin: DVec3, direction: DVec3) -> Option<Hit> {
    let [a, b, c] = mesh.corners(primitive);
    let (e1, e2, s) = (b - a, c - a, origin - a);
    let p = direction.cross(e2);
    let determinant = e1.dot(p);
    let q = s.cross(e1);
    let [u, v, t] = [s.dot(p), direction.dot(q), e2.dot(q)].map(|x| x / determinant);
    // false for NaN, that is, for a parallel triangle
    let inside = u >= 0.0 && v >= 0.0 && u + v <= 1.0 && t > 0.0;
    inside.then_some(Hit {
        t,
        primitive,
        back: determinant < 0.0,
        u,
        v,
    })
}
