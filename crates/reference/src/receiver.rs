//! The receiver of a pixel: the point of the G-buffer's primitive that its ray meets, and how far f32 may err from it.

use crate::band::Uncertainty;
use glam::DVec3;
use skiagraph_scene::Mesh;

/// Half an ulp of 1 in f32: the relative error of one rounding.
pub(crate) const F32_ROUNDING: f64 = 1.0 / (1u32 << 24) as f64;

/// Roundings in an edge function of a receiver, `dir · ((p + q) × (q − p))` with corners relative to the eye: the pixel's
/// direction (three products and two sums of rounded vectors, 4), corners relative to the eye (1), cross product (2), dot
/// product (2). Nine that all align do not happen, and the three edge functions' errors are added up below as if they did:
/// with 4, the worst of 200,000 random receivers errs by half of its bound (test below).
const EDGE_ROUNDINGS: f64 = 4.0;

/// Roundings in a position as the sum of barycentric × corner, in units of Σ |barycentric| |corner|: the sum of the edge
/// functions and the division by it (3), product (1), sums (2), less one for not aligning.
const POSITION_ROUNDINGS: f64 = 5.0;

/// Roundings in dot(Σ barycentric × normal, l) apart from the barycentrics' own: products and sums (6), the light's rounded direction (2).
const FACING_ROUNDINGS: f64 = 8.0;

/// Share of the determinant beyond which the edge functions' error makes the hit meaningless.
const INDETERMINATE: f64 = 0.25;

/// A pixel's receiver.
pub(crate) struct Receiver {
    /// Hit on the primitive's plane, world space.
    pub(crate) position: DVec3,
    /// The point of the primitive's border where it would lie, had the rasteriser not snapped corners; `None` where it lies on the primitive.
    pub(crate) on_border: Option<DVec3>,
    /// Interpolated, unnormalised vertex normal · unit vector towards the light.
    pub(crate) n_dot_l: f64,
    /// Bound on the f32 error of `n_dot_l`.
    pub(crate) n_dot_l_error: f64,
    /// Where f32 arithmetic may put the receiver; `None` where it may put it anywhere (a primitive seen edge-on).
    pub(crate) uncertainty: Option<Uncertainty>,
}

impl Receiver {
    /// The point where the ray from `eye` along `direction` meets the plane of `primitive`.
    ///
    /// Barycentrics are not clamped: a rasteriser snaps vertices to a subpixel grid, so that a pixel's centre may lie a little outside
    /// the primitive that covers it, and a deferred shader that does not clamp sees the same point. A primitive exactly
    /// edge-on has no such point; its centroid stands in, and the pixel is always in band.
    pub(crate) fn new(
        mesh: &Mesh,
        primitive: u32,
        eye: DVec3,
        direction: DVec3,
        towards_light: DVec3,
    ) -> Self {
        let world = mesh.corners(primitive);
        let normals = mesh.corner_normals(primitive);
        let [a, b, c] = world.map(|corner| corner - eye);
        let pairs = [(b, c), (c, a), (a, b)];
        let edges = pairs.map(|(p, q)| direction.dot((p + q).cross(q - p)));
        let determinant: f64 = edges.iter().sum();
        let reach = a.length().max(b.length()).max(c.length());
        // |(p + q) × (q − p)| ≤ 2 · reach · edge; the eye itself is rounded, which moves every corner by as much (√3, taken as 2).
        let lever =
            2.0 * (EDGE_ROUNDINGS * reach + 2.0 * eye.length()) * F32_ROUNDING * direction.length();
        let errors = pairs.map(|(p, q)| lever * (q - p).length() / determinant.abs());
        let error: f64 = errors.iter().sum();
        let determinate = error < INDETERMINATE;

        let weights = if determinant == 0.0 {
            [1.0 / 3.0; 3]
        } else {
            edges.map(|edge| edge / determinant)
        };
        let position = weighted(weights, world);
        let clamped = weights.map(|weight| weight.max(0.0));
        let on_border =
            (clamped != weights).then(|| weighted(clamped, world) / clamped.iter().sum::<f64>());
        let n_dot_l = weighted(weights, normals).dot(towards_light);
        // The larger of both lengths: a shader may sum corners relative to the eye and add the eye last.
        let length = |corner: DVec3| corner.length().max((corner - eye).length());
        let lengths: f64 = weights
            .iter()
            .zip(world)
            .map(|(w, corner)| w.abs() * length(corner))
            .sum();
        let position_error = POSITION_ROUNDINGS * F32_ROUNDING * lengths;
        let facing_error = FACING_ROUNDINGS
            * F32_ROUNDING
            * weights
                .iter()
                .zip(normals)
                .map(|(w, n)| w.abs() * n.length())
                .sum::<f64>();
        // Weight i off by errorᵢ moves the point along (cornerᵢ − point), before dividing by the new sum of weights.
        let scale = |i: usize| errors[i] / (1.0 - error);
        let n_dot_l_error = facing_error
            + (0..3)
                .map(|i| scale(i) * (normals[i].dot(towards_light) - n_dot_l).abs())
                .sum::<f64>();
        let uncertainty = determinate.then(|| Uncertainty {
            segments: std::array::from_fn(|i| (world[i] - position) * scale(i)),
            radius: position_error,
        });
        let n_dot_l_error = if determinate {
            n_dot_l_error
        } else {
            f64::INFINITY
        };
        Self {
            position,
            on_border,
            n_dot_l,
            n_dot_l_error,
            uncertainty,
        }
    }
}

fn weighted(weights: [f64; 3], points: [DVec3; 3]) -> DVec3 {
    weights
        .iter()
        .zip(points)
        .map(|(&weight, point)| point * weight)
        .sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::predicates::own_rounding;
    use glam::Vec3;
    use skiagraph_scene::{Camera, View};

    /// Position and n · l as shaders/surface.wgsl computes them.
    fn in_f32(mesh: &Mesh, camera: &Camera, [x, y]: [u32; 2], light: DVec3) -> (Vec3, f32) {
        let [eye, right, up, forward] =
            [camera.eye, camera.right, camera.up, camera.forward].map(DVec3::as_vec3);
        let eye_low = (camera.eye - eye.as_dvec3()).as_vec3();
        let (half_width, half_height) = (camera.half_width as f32, camera.half_height as f32);
        let ndc_x = (x as f32 + 0.5) / camera.viewport[0] as f32 * 2.0 - 1.0;
        let ndc_y = 1.0 - (y as f32 + 0.5) / camera.viewport[1] as f32 * 2.0;
        let direction = forward + right * (ndc_x * half_width) + up * (ndc_y * half_height);
        let corners = mesh.triangles[0].map(|i| mesh.positions[i as usize]);
        let normals = mesh.normal_indices[0].map(|i| mesh.normals[i as usize]);
        let relative = corners.map(|corner| (corner - eye) - eye_low);
        let [a, b, c] = relative;
        let edges = [(b, c), (c, a), (a, b)].map(|(p, q)| direction.dot((p + q).cross(q - p)));
        let weights = edges.map(|edge| edge / (edges[0] + edges[1] + edges[2]));
        let most = weights[0].max(weights[1]).max(weights[2]);
        let first = [1, 2]
            .into_iter()
            .find(|&i| weights[i] == most)
            .unwrap_or(0);
        let along = |i: usize| weights[i % 3] * (relative[i % 3] - relative[first]);
        let normal = (0..3).map(|i| normals[i] * weights[i]).sum::<Vec3>();
        (
            corners[first] + (along(first + 1) + along(first + 2)),
            normal.dot(light.as_vec3()),
        )
    }

    /// Random triangles under a pixel: no f32 receiver is farther from the f64 one than it may be, and the bounds are not many
    /// times what happens.
    #[test]
    fn f32_stays_within_the_bounds() {
        let mut state = 1u64;
        let mut random = |low: f64, high: f64| {
            // Knuth's MMIX generator; its upper bits are good enough here.
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            low + (high - low) * (state >> 11) as f64 / (1u64 << 53) as f64
        };
        let (mut farthest, mut most_turned, mut judged) = (0f64, 0f64, 0);
        let (mut off_ball, mut off_plane, mut passed_over, mut small) = (0f64, 0f64, 0f64, 0);
        for _ in 0..200_000 {
            let mut vector = |size: f64| {
                DVec3::new(
                    random(-size, size),
                    random(-size, size),
                    random(-size, size),
                )
            };
            let view = View {
                name: String::new(),
                eye: vector(100.0),
                direction: vector(1.0),
                up: DVec3::Y,
                fov_y_degrees: 60.0,
                near: 1.0,
                far: 1e4,
            };
            let camera = view.camera([640, 480]);
            let light = vector(1.0).normalize();
            let (shape, dice) = ([vector(1.0), vector(1.0), vector(1.0)], vector(1.0));
            let normals = [vector(1.0), vector(1.0), vector(1.0)];
            // All over the triangle, along its edges and at its corners.
            let share = vector(1.0).map(|c| c.abs().powi(3) + 1e-6);
            let pixel = [dice.x, dice.y].map(|die| (die.abs() * 479.0) as u32);
            let ray = camera.pixel_direction(pixel[0], pixel[1]);
            // Distances of 1 to 1000, sizes of a hundredth of the distance to ten times it, around the pixel's ray.
            let distance = 10f64.powf(1.5 + 1.5 * dice.z);
            let size = distance * 10f64.powf(-0.5 + 1.5 * shape[0].x);
            let mean = weighted(share.to_array(), shape) / share.element_sum();
            let place = |corner| view.eye + ray * distance + (corner - mean) * size;
            let mesh = Mesh {
                positions: shape.map(|corner| place(corner).as_vec3()).to_vec(),
                triangles: vec![[0, 1, 2]],
                normals: normals.map(|normal| normal.normalize().as_vec3()).to_vec(),
                normal_indices: vec![[0, 1, 2]],
                ..Mesh::default()
            };
            let exact = Receiver::new(&mesh, 0, view.eye, ray, light);
            let Some(uncertainty) = exact.uncertainty else {
                continue;
            };
            let (position, n_dot_l) = in_f32(&mesh, &camera, pixel, light);
            let error = position.as_dvec3() - exact.position;
            let bound = uncertainty.radius + uncertainty.along(error.normalize_or_zero());
            let turned = (f64::from(n_dot_l) - exact.n_dot_l).abs();
            farthest = farthest.max(error.length() / bound);
            most_turned = most_turned.max(turned / exact.n_dot_l_error);
            judged += 1;
            // A caster that a ray passes over because it is nearer than this must not be robust for the band.
            let own = f64::from(own_rounding(position, view.eye.as_vec3()));
            passed_over = passed_over.max(own / uncertainty.radius);
            let [a, b, c] = mesh.corners(0);
            let normal = (b - a).cross(c - a).normalize();
            let off = normal.dot(position.as_dvec3() - a).abs();
            // The segments lie in the plane.
            off_ball = off_ball.max(off / uncertainty.radius);
            let reach = (position.as_dvec3() - view.eye).length();
            let corners = [a, b, c].map(|corner| (corner - exact.position).length());
            if corners.iter().all(|&away| away <= reach) {
                off_plane = off_plane.max(off / own);
                small += 1;
            }
        }
        println!(
            "off their planes by at most {off_ball:.3} of the bound; {small} of small triangles by {off_plane:.3} of their own rounding, which is {passed_over:.3} of the bound"
        );
        assert!(small > 50_000);
        assert!(off_ball < 1.0 && off_ball > 0.1, "{off_ball}");
        assert!(off_plane < 1.0 && off_plane > 0.1, "{off_plane}");
        assert!(passed_over <= 1.0, "{passed_over}");
        println!("{judged} receivers, at most {farthest:.3} and {most_turned:.3} of the bounds");
        assert!(judged > 150_000);
        assert!(farthest < 1.0 && farthest > 0.1, "{farthest}");
        assert!(most_turned < 1.0 && most_turned > 0.1, "{most_turned}");
    }
}
