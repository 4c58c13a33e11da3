//! Receivers as `shaders/surface.wgsl` finds them, in f32 on the CPU, against the oracle's bounds.

use glam::{DVec3, Vec3};
use skiagraph_reference::{Receiver, receiver::INSET};
use skiagraph_scene::{Camera, DirectionalLight, Mesh, View};
use skiagraph_tests::cpu_reference::predicates::receiver_error_bound;

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
    let planes = [(b, c), (c, a), (a, b)].map(|(p, q)| (p + q).cross(q - p));
    let edges = planes.map(|plane| direction.dot(plane));
    let across = right * (2.0 * half_width / camera.viewport[0] as f32);
    let down = up * (2.0 * half_height / camera.viewport[1] as f32);
    let margins =
        planes.map(|plane| INSET as f32 * (across.dot(plane).abs() + down.dot(plane).abs()));
    let side = (edges[0] + edges[1] + edges[2]).signum();
    let inside: [f32; 3] = std::array::from_fn(|i| (side * edges[i]).max(margins[i]));
    let weights = inside.map(|edge| edge / (inside[0] + inside[1] + inside[2]));
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

/// Random triangles under a pixel: no f32 receiver is farther from the f64 one than it may be,
/// and the bounds are not many times what happens.
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
        let mut vector = |size: f64| DVec3::from([size; 3].map(|size| random(-size, size)));
        let view = View {
            name: String::new(),
            eye: vector(100.0),
            direction: vector(1.0),
            up: DVec3::Y,
            fov_y_degrees: 60.0,
            near: 1.0,
            far: 1e4,
            light: None,
        };
        let camera = view.camera([640, 480]);
        let light = vector(1.0).normalize();
        let (shape, dice) = ([vector(1.0), vector(1.0), vector(1.0)], vector(1.0));
        let normals = [vector(1.0), vector(1.0), vector(1.0)];
        // All over the triangle, along its edges and at its corners.
        let share = vector(1.0).map(|c| c.abs().powi(3) + 1e-6);
        let pixel = [dice.x, dice.y].map(|die| (die.abs() * 479.0) as u32);
        let ray = camera.pixel_direction(pixel[0], pixel[1]);
        // Distances of 1 to 1000, sizes of a hundredth of the distance to ten times it, around
        // the pixel's ray.
        let distance = 10f64.powf(1.5 + 1.5 * dice.z);
        let size = distance * 10f64.powf(-0.5 + 1.5 * shape[0].x);
        let sum = share.x * shape[0] + share.y * shape[1] + share.z * shape[2];
        let mean = sum / share.element_sum();
        let place = |corner| view.eye + ray * distance + (corner - mean) * size;
        let mesh = Mesh {
            positions: shape.map(|corner| place(corner).as_vec3()).to_vec(),
            triangles: vec![[0, 1, 2]],
            normals: normals.map(|normal| normal.normalize().as_vec3()).to_vec(),
            normal_indices: vec![[0, 1, 2]],
            ..Mesh::default()
        };
        let sun = DirectionalLight::new(-light).into();
        let exact = Receiver::new(&mesh, 0, &camera, pixel, &sun);
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
        // A caster that a ray passes over because it is nearer than this must not be robust for
        // the oracle.
        let own = f64::from(receiver_error_bound(position, view.eye.as_vec3()));
        passed_over = passed_over.max(own / uncertainty.radius);
        let [a, b, c] = mesh.corners(0);
        let normal = (b - a).cross(c - a).normalize();
        let off = normal.dot(position.as_dvec3() - a).abs();
        // The segments lie in the plane.
        off_ball = off_ball.max(off / uncertainty.radius);
        let eye_distance = (position.as_dvec3() - view.eye).length();
        let corners = [a, b, c].map(|corner| (corner - exact.position).length());
        if corners.iter().all(|&away| away <= eye_distance) {
            off_plane = off_plane.max(off / own);
            small += 1;
        }
    }
    println!(
        "off their planes by at most {off_ball:.3} of the bound; {small} of small triangles \
         by {off_plane:.3} of their own rounding, which is {passed_over:.3} of the bound"
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
