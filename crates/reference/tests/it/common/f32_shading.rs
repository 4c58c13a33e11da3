//! A deferred ray-traced shadow as a GPU computes it, in f32 throughout: the method whose every
//! error must be in indeterminate pixels.

use glam::{DVec3, Vec3};
use rayon::prelude::*;
use skiagraph_reference::{BACKGROUND, OracleMode, receiver::INSET};
use skiagraph_scene::{Bvh, Camera, LIGHT_GAP, LightKind, Mesh};

/// Visibility and status per pixel.
pub fn shade(
    mesh: &Mesh,
    bvh: &Bvh,
    camera: &Camera,
    light: impl Into<LightKind>,
    primitives: &[u32],
    mode: OracleMode,
) -> (Vec<u8>, Vec<u8>) {
    let [eye, right, up, forward] =
        [camera.eye, camera.right, camera.up, camera.forward].map(DVec3::as_vec3);
    let (half_width, half_height) = (camera.half_width as f32, camera.half_height as f32);
    let light = light.into();
    let [width, height] = camera.viewport;
    let pixel = |index: usize| {
        let primitive = primitives[index];
        if primitive == BACKGROUND {
            return (0, 0);
        }
        let (x, y) = (index % width as usize, index / width as usize);
        let ndc_x = (x as f32 + 0.5) / width as f32 * 2.0 - 1.0;
        let ndc_y = 1.0 - (y as f32 + 0.5) / height as f32 * 2.0;
        let direction = forward + right * (ndc_x * half_width) + up * (ndc_y * half_height);
        let corners = mesh.triangles[primitive as usize].map(|i| mesh.positions[i as usize]);
        let normals = mesh.normal_indices[primitive as usize].map(|i| mesh.normals[i as usize]);
        let [a, b, c] = corners.map(|corner| corner - eye);
        let planes = [(b, c), (c, a), (a, b)].map(|(p, q)| (p + q).cross(q - p));
        let edges = planes.map(|plane| direction.dot(plane));
        let across = right * (2.0 * half_width / width as f32);
        let down = up * (2.0 * half_height / height as f32);
        let margins =
            planes.map(|plane| INSET as f32 * (across.dot(plane).abs() + down.dot(plane).abs()));
        let side = (edges[0] + edges[1] + edges[2]).signum();
        let inside: [f32; 3] = std::array::from_fn(|i| (side * edges[i]).max(margins[i]));
        let weights = inside.map(|edge| edge / (inside[0] + inside[1] + inside[2]));
        let normal: Vec3 = (0..3).map(|i| normals[i] * weights[i]).sum();
        let position: Vec3 = (0..3).map(|i| corners[i] * weights[i]).sum();
        let (to_light, distance, shines) = towards(&light, position);
        if !shines || normal.dot(to_light) <= 0.0 {
            return (0, 1);
        }
        let (origin, own) = match mode {
            OracleMode::Exact => (position, primitive),
            OracleMode::Offset(length) => (position + to_light * length as f32, BACKGROUND),
        };
        let lit = !occluded(mesh, bvh, origin, to_light, distance, own);
        (u8::from(lit), if lit { 2 } else { 3 })
    };
    (0..primitives.len()).into_par_iter().map(pixel).unzip()
}

/// Unit vector to the light, the length of a shadow ray, and whether the light shines there, as
/// shaders/shared/light.wgsl has them.
fn towards(light: &LightKind, position: Vec3) -> (Vec3, f32, bool) {
    let Some(place) = light.position() else {
        return (
            light.towards(DVec3::ZERO).direction.as_vec3(),
            f32::INFINITY,
            true,
        );
    };
    let rounded = place.as_vec3();
    let way = (rounded - position) + (place - rounded.as_dvec3()).as_vec3();
    let shines = match (light.direction(), light.edge_cosine()) {
        (Some(axis), Some(edge)) => {
            way.dot(-axis.normalize().as_vec3()) >= edge as f32 * way.length()
        }
        _ => true,
    };
    let distance = way.length() * (1.0 - LIGHT_GAP as f32);
    (way * way.length_squared().sqrt().recip(), distance, shines)
}

fn occluded(
    mesh: &Mesh,
    bvh: &Bvh,
    origin: Vec3,
    direction: Vec3,
    distance: f32,
    own: u32,
) -> bool {
    let inverse = direction.to_array().map(|c| {
        1.0 / if c.abs() < 1e-20 {
            1e-20f32.copysign(c)
        } else {
            c
        }
    });
    let mut open = if bvh.nodes.is_empty() {
        vec![]
    } else {
        vec![0]
    };
    while let Some(index) = open.pop() {
        let node = &bvh.nodes[index as usize];
        let (mut near, mut far) = (0f32, f32::INFINITY);
        for axis in 0..3 {
            // Generous: what is under test is the triangle test, not this box test.
            let pad = 1e-5 * (origin[axis].abs() + node.min[axis].abs() + node.max[axis].abs());
            let low = (node.min[axis] - pad - origin[axis]) * inverse[axis];
            let high = (node.max[axis] + pad - origin[axis]) * inverse[axis];
            near = near.max(low.min(high));
            far = far.min(low.max(high));
        }
        if near > far {
            continue;
        }
        if node.count == 0 {
            open.extend([node.first, node.first + 1]);
            continue;
        }
        for slot in node.first..node.first + node.count {
            let primitive = bvh.primitives[slot as usize];
            if primitive != own && hit(mesh, primitive, origin, direction, distance) {
                return true;
            }
        }
    }
    false
}

/// Woop, Benthin, Wald 2013 in f32, without its fallback to f64 for edge functions of 0, which no
/// GPU has.
fn hit(mesh: &Mesh, primitive: u32, origin: Vec3, direction: Vec3, distance: f32) -> bool {
    let d = direction.to_array();
    let z = (0..3).fold(0, |best, axis| {
        if d[axis].abs() > d[best].abs() {
            axis
        } else {
            best
        }
    });
    let (x, y) = ((z + 1) % 3, (z + 2) % 3);
    let (sx, sy, sz) = (d[x] / d[z], d[y] / d[z], 1.0 / d[z]);
    let [a, b, c] = mesh.triangles[primitive as usize].map(|i| {
        let v = mesh.positions[i as usize] - origin;
        Vec3::new(v[x] - sx * v[z], v[y] - sy * v[z], sz * v[z])
    });
    let edge = |p: Vec3, q: Vec3| p.x * q.y - p.y * q.x;
    let (u, v, w) = (edge(c, b), edge(a, c), edge(b, a));
    if (u < 0.0 || v < 0.0 || w < 0.0) && (u > 0.0 || v > 0.0 || w > 0.0) {
        return false;
    }
    let determinant = u + v + w;
    let t = (u * a.z + v * b.z + w * c.z) / determinant;
    determinant != 0.0 && t > 0.0 && t < distance
}
