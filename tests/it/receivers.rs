//! Receivers as `shaders/surface.wgsl` finds them, in f32 on the CPU, against the oracle's bounds.

use glam::{DVec3, Vec3};
use skiagraph_reference::{Receiver, receiver::INSET};
use skiagraph_scene::{Camera, DirectionalLight, Mesh, View};
use skiagraph_tests::cpu_reference::arithmetic::{Arithmetic, Order, Rounding};

/// Position and n · l as shaders/surface.wgsl computes them, rounded as `by` says.
fn in_f32(
    by: Arithmetic,
    mesh: &Mesh,
    camera: &Camera,
    [x, y]: [u32; 2],
    light: DVec3,
) -> (Vec3, f32) {
    type Vector = [f32; 3];
    let add = |p: Vector, q: Vector| [0, 1, 2].map(|i| by.add(p[i], q[i]));
    let sub = |p: Vector, q: Vector| [0, 1, 2].map(|i| by.sub(p[i], q[i]));
    let scaled = |p: Vector, factor: f32| p.map(|c| by.mul(c, factor));
    let sum = |terms: [Vector; 3]| [0, 1, 2].map(|i| by.sum(terms.map(|term| term[i])));

    let [eye, right, up, forward] = [camera.eye, camera.right, camera.up, camera.forward]
        .map(|vector| vector.as_vec3().to_array());
    let eye_low = (camera.eye - DVec3::from(eye.map(f64::from))).as_vec3();
    let (half_width, half_height) = (camera.half_width as f32, camera.half_height as f32);
    let [width, height] = camera.viewport.map(|size| size as f32);
    let ndc_x = by.sub(by.mul(by.div(x as f32 + 0.5, width), 2.0), 1.0);
    let ndc_y = by.sub(1.0, by.mul(by.div(y as f32 + 0.5, height), 2.0));
    let aside = scaled(right, by.mul(ndc_x, half_width));
    let direction = sum([forward, aside, scaled(up, by.mul(ndc_y, half_height))]);
    let corners = mesh.triangles[0].map(|i| mesh.positions[i as usize].to_array());
    let normals = mesh.normal_indices[0].map(|i| mesh.normals[i as usize].to_array());
    let relative = corners.map(|corner| sub(sub(corner, eye), eye_low.to_array()));
    let [a, b, c] = relative;
    let planes = [(b, c), (c, a), (a, b)].map(|(p, q)| by.cross(add(p, q), sub(q, p)));
    let edges = planes.map(|plane| by.dot(direction, plane));
    let across = scaled(right, by.div(by.mul(2.0, half_width), width));
    let down = scaled(up, by.div(by.mul(2.0, half_height), height));
    let margins = planes.map(|plane| {
        let reach = by.add(by.dot(across, plane).abs(), by.dot(down, plane).abs());
        by.mul(INSET as f32, reach)
    });
    let side = by.sum(edges).signum();
    let inside: [f32; 3] = std::array::from_fn(|i| (side * edges[i]).max(margins[i]));
    let total = by.sum(inside);
    let weights = inside.map(|edge| by.div(edge, total));
    let most = weights[0].max(weights[1]).max(weights[2]);
    let first = [1, 2]
        .into_iter()
        .find(|&i| weights[i] == most)
        .unwrap_or(0);
    let along = |i: usize| scaled(sub(relative[i % 3], relative[first]), weights[i % 3]);
    let normal = sum([0, 1, 2].map(|i| scaled(normals[i], weights[i])));
    (
        Vec3::from(sum([along(first + 1), along(first + 2), corners[first]])),
        by.dot(normal, light.as_vec3().to_array()),
    )
}

/// How far receivers were off, as shares of what they may be off by.
#[derive(Default)]
struct Off {
    judged: u32,
    /// Farthest receiver, as a share of the oracle's bound.
    farthest: f64,
    /// n · l, of the oracle's bound.
    most_turned: f64,
    /// Their planes, of the oracle's ball.
    off_ball: f64,
    /// Those on triangles no larger than they are far.
    small: u32,
    /// These their planes, of `receiver_error_bound`.
    off_plane: f64,
    /// `receiver_error_bound`, of the oracle's ball.
    passed_over: f64,
}

/// Random triangles under a pixel.
fn measured(by: Arithmetic, count: u32) -> Off {
    let mut state = 1u64;
    let mut random = |low: f64, high: f64| {
        // Knuth's MMIX generator; its upper bits are good enough here.
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        low + (high - low) * (state >> 11) as f64 / (1u64 << 53) as f64
    };
    let mut off = Off::default();
    for _ in 0..count {
        let mut vector = |size: f64| DVec3::from([size; 3].map(|size| random(-size, size)));
        let view = View {
            name: String::new(),
            eye: vector(100.0),
            direction: vector(1.0),
            near: 1.0,
            far: 1e4,
            ..View::default()
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
        let (position, n_dot_l) = in_f32(by, &mesh, &camera, pixel, light);
        let error = position.as_dvec3() - exact.position;
        let bound = uncertainty.radius + uncertainty.along(error.normalize_or_zero());
        let turned = (f64::from(n_dot_l) - exact.n_dot_l).abs();
        off.farthest = off.farthest.max(error.length() / bound);
        off.most_turned = off.most_turned.max(turned / exact.n_dot_l_error);
        off.judged += 1;
        // A caster that a ray passes over because it is nearer than this must not be robust for
        // the oracle.
        let eye = view.eye.as_vec3().to_array();
        let own = f64::from(by.receiver_error_bound(position.to_array(), eye));
        off.passed_over = off.passed_over.max(own / uncertainty.radius);
        let [a, b, c] = mesh.corners(0);
        let normal = (b - a).cross(c - a).normalize();
        let aside = normal.dot(position.as_dvec3() - a).abs();
        // The segments lie in the plane.
        off.off_ball = off.off_ball.max(aside / uncertainty.radius);
        let eye_distance = (position.as_dvec3() - view.eye).length();
        let corners = [a, b, c].map(|corner| (corner - exact.position).length());
        if corners.iter().all(|&away| away <= eye_distance) {
            off.off_plane = off.off_plane.max(aside / own);
            off.small += 1;
        }
    }
    println!(
        "{by:?}: {} receivers, off by {:.3} of the bound, n · l by {:.3}; off their planes by \
         {:.3} of the ball, {} of small triangles by {:.3} of their own rounding, which is {:.3} \
         of the ball",
        off.judged,
        off.farthest,
        off.most_turned,
        off.off_ball,
        off.small,
        off.off_plane,
        off.passed_over
    );
    off
}

/// No f32 receiver is farther from the f64 one than it may be, and the bounds are not many times
/// what happens.
#[test]
fn f32_stays_within_the_bounds() {
    let off = measured(Arithmetic::PLAIN, 200_000);
    assert!(off.judged > 150_000 && off.small > 50_000);
    for share in [off.farthest, off.most_turned, off.off_ball, off.off_plane] {
        assert!(share < 1.0 && share > 0.1, "{share}");
    }
    assert!(off.passed_over <= 1.0, "{}", off.passed_over);
}

/// Fused, reordered, rounded to other neighbours: within the oracle's bounds, so that a pixel whose
/// receiver is off by that is indeterminate. `receiver_error_bound` needs the nearest neighbour and
/// the corner added last; else receivers are off their planes by up to twice as much.
#[test]
fn other_arithmetics_stay_within_the_oracle_s_bounds() {
    let orders = [Order::Backwards, Order::OuterFirst].map(|order| Arithmetic {
        order,
        ..Arithmetic::PLAIN
    });
    for by in Arithmetic::every(7).chain(orders) {
        let off = measured(by, 20_000);
        assert!(off.judged > 15_000 && off.small > 5_000);
        for share in [off.farthest, off.most_turned, off.off_ball] {
            assert!(share < 1.0 && share > 0.1, "{by:?}: {share}");
        }
        assert!(off.passed_over <= 1.0, "{by:?}: {}", off.passed_over);
        let is_written = by.rounding == Rounding::Nearest && by.order == Order::Written;
        let most = if is_written { 1.0 } else { 2.0 };
        assert!(off.off_plane < most, "{by:?}: {}", off.off_plane);
        assert!(is_written || off.off_plane > 1.0, "{by:?}: it holds");
    }
}
