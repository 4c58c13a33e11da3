//! Every ray against every triangle, in f64.

use glam::{DVec3, Vec3};
use skiagraph_scene::Mesh;

/// The GPU's ray.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct Ray {
    pub origin: Vec3,
    pub t_min: f32,
    pub direction: Vec3,
    pub t_max: f32,
}

/// The GPU's hit.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct Hit {
    pub t: f32,
    pub primitive: u32,
    pub u: f32,
    pub v: f32,
}

pub const MISS: u32 = u32::MAX;

/// A hit in f64, with how near the ray comes to the triangle's border (smallest barycentric
/// weight).
#[derive(Clone, Copy, Debug)]
pub struct Exact {
    pub t: f64,
    pub primitive: u32,
    pub weights: DVec3,
}

/// Where the ray meets the plane of a triangle, whatever the weights; Möller and Trumbore's
/// determinants.
pub fn plane_hit(mesh: &Mesh, primitive: u32, ray: &Ray) -> Option<Exact> {
    let [a, b, c] = mesh.corners(primitive);
    let (origin, direction) = (ray.origin.as_dvec3(), ray.direction.as_dvec3());
    let (ab, ac, to) = (b - a, c - a, origin - a);
    let normal = direction.cross(ac);
    let determinant = ab.dot(normal);
    if determinant == 0.0 {
        return None;
    }
    let u = to.dot(normal) / determinant;
    let v = direction.dot(to.cross(ab)) / determinant;
    let t = ac.dot(to.cross(ab)) / determinant;
    Some(Exact {
        t,
        primitive,
        weights: DVec3::new(1.0 - u - v, u, v),
    })
}

/// All hits whose smallest weight is at least `border` (negative: near misses too), nearest first.
pub fn hits(mesh: &Mesh, ray: &Ray, skip: u32, border: f64) -> Vec<Exact> {
    let mut hits: Vec<Exact> = (0..mesh.triangles.len() as u32)
        .filter(|&primitive| primitive != skip)
        .filter_map(|primitive| plane_hit(mesh, primitive, ray))
        .filter(|hit| hit.weights.min_element() >= border)
        .filter(|hit| hit.t > f64::from(ray.t_min) && hit.t <= f64::from(ray.t_max))
        .collect();
    hits.sort_by(|a, b| a.t.total_cmp(&b.t));
    hits
}
