//! The tracer on the GPU against every ray × every triangle in f64.

use crate::support::{
    brute::{self, Hit, MISS, Ray},
    graphs::{self, Extended, run_text, trace, trace_all, trace_by},
    meshes,
    random::Random,
    scenes::load,
};
use glam::{DVec3, Vec3};
use skiagraph_graph::{Capture, Graph, PlanRequest};
use skiagraph_passes::{SceneProvider, registry};
use skiagraph_reference::{Error, Oracle, OracleMode, Progress, Statistics, statistics};
use skiagraph_scene::{DirectionalLight, Mesh, Scene, View};
use std::sync::Arc;

/// Weight by which a ray must miss or hit a triangle's border for f32 to be sure of it.
const BORDER: f64 = 1e-5;

#[test]
fn rays_are_in_buffers_or_of_a_module() {
    let provider = SceneProvider::new(load("park"));
    for fields in [
        r#"rays: "rays""#,
        r#"of: "shared/ray_buffers.wgsl""#,
        r#"of: "shared/ray_buffers.wgsl", most: "1", skip: "number""#,
        r#"rays: "rays", hits: "hits", most: "1""#,
    ] {
        let document = format!(
            r#"(format: 3, description: "rays", materials: [Buffer(name: "rays", count: 1),
                Buffer(name: "hits", count: 1), Buffer(name: "number", count: 1, data: [1])],
                passes: [Clear(name: "clear", target: "rays"),
                    Trace(name: "trace", {fields}, count: "number", mode: Any)],
                outputs: ["hits"])"#
        );
        let files = graphs::layered(&[("test.ron", &document)]);
        let graph = Graph::load("test.ron", &registry(), &files);
        let graph = graph.unwrap_or_else(|errors| panic!("{errors}"));
        let errors = graph.plan(&PlanRequest::new([8, 8], &provider));
        let errors = errors.expect_err(fields).to_string();
        let says = "a `Trace` has either `rays` and `hits`, or `of` and `most`";
        assert!(errors.contains(says), "{fields}: {errors}");
    }
}

#[test]
fn random_rays_through_a_soup() {
    let mesh = meshes::soup(400, 0.3, 1);
    let mut random = Random(2);
    let rays: Vec<Ray> = (0..4000)
        .map(|_| Ray {
            origin: random.vector() * 2.0,
            t_min: 0.0,
            direction: random.vector(),
            t_max: 4.0 * random.unit(),
        })
        .collect();
    let any = trace_all(&mesh, &rays, "Any");
    let closest = trace_all(&mesh, &rays, "Closest");
    let mut hits = 0;
    for ((ray, any), closest) in rays.iter().zip(&any).zip(&closest) {
        let sure = brute::hits(&mesh, ray, MISS, BORDER);
        let possible = brute::hits(
            &mesh,
            &Ray {
                t_max: ray.t_max * 1.00001,
                ..*ray
            },
            MISS,
            -BORDER,
        );
        for hit in [any, closest] {
            if hit.primitive == MISS {
                assert_eq!(hit.t, ray.t_max);
                assert!(
                    sure.iter().all(|s| s.t > f64::from(ray.t_max) * 0.99999),
                    "{ray:?} misses {sure:?}"
                );
            } else {
                let exact = possible
                    .iter()
                    .find(|p| p.primitive == hit.primitive)
                    .unwrap_or_else(|| panic!("{ray:?} hits {hit:?}, {possible:?}"));
                assert!(
                    (exact.t - f64::from(hit.t)).abs() < 1e-4 * exact.t.max(1.0),
                    "{hit:?} {exact:?}"
                );
                assert!(
                    (exact.weights.y - f64::from(hit.u)).abs() < 1e-3
                        && (exact.weights.z - f64::from(hit.v)).abs() < 1e-3,
                    "{hit:?} {exact:?}"
                );
            }
        }
        if let (Some(nearest), true) = (sure.first(), closest.primitive != MISS) {
            hits += 1;
            assert!(
                f64::from(closest.t) <= nearest.t + 1e-5,
                "{ray:?}: {closest:?} is not the nearest, {nearest:?} is"
            );
        }
    }
    assert!(
        hits > 500,
        "{hits} rays hit something: too few to mean anything"
    );
}

#[test]
fn no_ray_escapes_from_a_closed_mesh() {
    let mesh = meshes::potato(4, 0.3, 3);
    for (scale, offset) in [
        (1.0, Vec3::ZERO),
        (1e-4, Vec3::ZERO),
        (1e6, Vec3::ZERO),
        (1.0, Vec3::new(1e4, -3e3, 7e3)),
        (3.0, Vec3::splat(1e7)),
    ] {
        let placed = Mesh {
            positions: mesh.positions.iter().map(|&p| p * scale + offset).collect(),
            ..mesh.clone()
        };
        let mut random = Random(4);
        let mut rays = Vec::new();
        for index in 0..6000 {
            let triangle = placed.triangles
                [(random.unit() * placed.triangles.len() as f32) as usize]
                .map(|i| placed.positions[i as usize]);
            // Through a corner, a point of an edge, or its middle.
            let target = match index % 3 {
                0 => triangle[0],
                1 => triangle[0].lerp(triangle[1], random.unit()),
                _ => (triangle[0] + triangle[1]) * 0.5,
            };
            let origin = offset + random.vector() * 0.4 * scale;
            let direction = if index % 2 == 0 {
                target - origin
            } else {
                (target - origin) * random.unit().max(0.01) / scale
            };
            rays.push(Ray {
                origin,
                t_min: 0.0,
                direction,
                t_max: 1e30,
            });
        }
        // Along the axes, straight through corners, from the plane through the middle.
        for (index, &corner) in placed.positions.iter().enumerate() {
            let mut origin = corner;
            origin[index % 3] = offset[index % 3];
            if origin.distance(offset) < 0.8 * scale {
                let axis = Vec3::AXES[index % 3] * if index % 2 == 0 { 1.0 } else { -1.0 };
                rays.push(Ray {
                    origin,
                    t_min: 0.0,
                    direction: axis,
                    t_max: 1e30,
                });
            }
        }
        assert!(
            rays.len() > 6300,
            "too few rays along the axes: {}",
            rays.len() - 6000
        );
        for mode in ["Any", "Closest"] {
            let hits = trace_all(&placed, &rays, mode);
            let escaped: Vec<_> = rays
                .iter()
                .zip(&hits)
                .filter(|(_, hit)| hit.primitive == MISS)
                .collect();
            assert!(
                escaped.is_empty(),
                "scale {scale} offset {offset}: {} rays escape, first {:?}",
                escaped.len(),
                escaped[0]
            );
        }
    }
}

#[test]
fn a_ray_does_not_see_what_it_skips() {
    let mesh = meshes::soup(400, 0.3, 5);
    let mut random = Random(6);
    let mut ray = || Ray {
        origin: random.vector(),
        t_min: 0.0,
        direction: random.vector(),
        t_max: 4.0,
    };
    let rays: Vec<Ray> = (0..1000).map(|_| ray()).collect();
    let first = trace_all(&mesh, &rays, "Closest");
    let skip: Vec<u32> = first.iter().map(|hit| hit.primitive).collect();
    let second = trace(&mesh, &rays, Some(&skip), rays.len() as u32, "Closest");
    let any = trace(&mesh, &rays, Some(&skip), rays.len() as u32, "Any");
    let mut further = 0;
    for (index, ray) in rays.iter().enumerate() {
        let hits = [first[index], second[index], any[index]];
        if first[index].primitive == MISS {
            assert!(
                hits.iter().all(|hit| hit.primitive == MISS),
                "{ray:?}: {hits:?}"
            );
            continue;
        }
        assert!(second[index].primitive != skip[index] && any[index].primitive != skip[index]);
        assert!(second[index].t >= first[index].t, "{ray:?}: {hits:?}");
        assert_eq!(
            second[index].primitive == MISS,
            any[index].primitive == MISS,
            "{ray:?}: {hits:?}"
        );
        further += usize::from(second[index].primitive != MISS);
    }
    assert!(
        further > 100,
        "{further} rays met a second triangle: too few to mean anything"
    );
}

#[test]
fn only_the_counted_rays_are_traced() {
    let mesh = meshes::potato(2, 0.1, 7);
    let ray = Ray {
        origin: Vec3::ZERO,
        t_min: 0.0,
        direction: Vec3::new(0.3, 0.2, 0.9),
        t_max: 10.0,
    };
    // A count beyond the buffers is cut off at their ends.
    for (count, traced) in [(0, 0), (1, 1), (64, 64), (65, 65), (200, 200), (1000, 200)] {
        let hits = trace(&mesh, &[ray; 200], None, count, "Any");
        // Pixels that are not traced stay as the graph made them: zeros.
        assert!(
            hits[..traced].iter().all(|hit| hit.t > 0.9 && hit.t < 1.5),
            "{count}"
        );
        assert!(hits[traced..].iter().all(|hit| hit.t == 0.0), "{count}");
    }
}

#[test]
fn the_interval_of_a_ray_is_open_below_and_closed_above() {
    let mesh = meshes::mesh(
        vec![
            Vec3::new(-1.0, -1.0, 2.0),
            Vec3::new(3.0, -1.0, 2.0),
            Vec3::new(-1.0, 3.0, 2.0),
        ],
        vec![[0, 1, 2]],
    );
    let ray = |t_min, t_max| Ray {
        origin: Vec3::ZERO,
        t_min,
        direction: Vec3::Z,
        t_max,
    };
    let none = Ray {
        direction: Vec3::ZERO,
        ..ray(0.0, 10.0)
    };
    let away = Ray {
        direction: Vec3::NEG_Z,
        ..ray(0.0, 10.0)
    };
    let rays = [
        ray(0.0, 10.0),
        ray(0.0, 2.0),
        ray(2.0, 10.0),
        ray(1.9, 10.0),
        ray(0.0, 1.9),
        ray(10.0, 0.0),
        none,
        away,
    ];
    let hits = trace_all(&mesh, &rays, "Closest");
    let hit_flags: Vec<bool> = hits.iter().map(|hit| hit.primitive == 0).collect();
    assert_eq!(
        hit_flags,
        [true, true, false, true, false, false, false, false],
        "{hits:?}"
    );
    assert_eq!(
        hits[0],
        Hit {
            t: 2.0,
            primitive: 0,
            u: 0.25,
            v: 0.25
        }
    );
}

#[test]
fn a_ray_in_the_plane_of_a_triangle_beside_it_misses() {
    // All corners on one line as the ray sees them, two of three edge functions 0, and the third
    // off by rounding.
    let corners = [
        [-0.75, -0.75, 1.375],
        [-0.625, -0.625, 0.875],
        [-1.125, -0.75, 0.625],
    ];
    let mesh = meshes::mesh(corners.map(Vec3::from).to_vec(), vec![[0, 1, 2]]);
    let ray = Ray {
        origin: Vec3::new(0.0, -0.25, -0.125),
        t_min: 0.0,
        direction: Vec3::new(-0.875, -0.375, 0.5),
        t_max: 10.0,
    };
    assert_eq!(trace_all(&mesh, &[ray], "Any")[0].primitive, MISS);
}

#[test]
fn triangles_without_area_and_empty_scenes_are_missed() {
    let line = meshes::mesh(
        vec![Vec3::NEG_X, Vec3::X, Vec3::X * 2.0],
        vec![[0, 1, 2], [0, 0, 0], [0, 1, 1]],
    );
    let ray = Ray {
        origin: Vec3::new(0.0, 0.0, -1.0),
        t_min: 0.0,
        direction: Vec3::Z,
        t_max: 10.0,
    };
    // Edge-on, too: a ray in the triangle's plane.
    let edge_on = Ray {
        origin: Vec3::new(-5.0, 0.0, 0.0),
        direction: Vec3::X,
        ..ray
    };
    let flat = meshes::mesh(vec![Vec3::ZERO, Vec3::X, Vec3::Y], vec![[0, 1, 2]]);
    for mesh in [line, flat, Mesh::default()] {
        let mut rays = vec![edge_on];
        if mesh.triangles.len() != 1 {
            rays.push(ray);
        }
        let hits = trace_all(&mesh, &rays, "Any");
        assert!(hits.iter().all(|hit| hit.primitive == MISS), "{hits:?}");
    }
}

#[test]
fn the_dispatch_is_folded_to_two_dimensions() {
    let row = 65_535u32;
    for (count, expected) in [
        (0, [0, 0, 1]),
        (1, [1, 1, 1]),
        (64, [1, 1, 1]),
        (65, [2, 1, 1]),
        (row * 64, [row, 1, 1]),
        (row * 64 + 1, [row, 2, 1]),
        (row * 64 * 3 - 63, [row, 3, 1]),
        (u32::MAX, [row, 1025, 1]),
    ] {
        let light = DirectionalLight::new(DVec3::NEG_Y);
        let scene = Scene {
            name: "test".into(),
            mesh: Mesh::default(),
            views: vec![],
            lights: vec![light.into()],
        };
        let mut provider = Extended::new(SceneProvider::new(Arc::new(scene)));
        provider.add("test.number", &[count]);
        let document = r#"(
            format: 3,
            description: "the size of a dispatch",
            materials: [Buffer(name: "groups")],
            passes: [
                Compute(
                    name: "dispatch_arguments",
                    dispatch: Groups(1, 1, 1),
                    bind: {"count": "test.number"},
                ),
            ],
            outputs: ["groups"],
        )"#;
        let groups: Vec<u32> =
            bytemuck::pod_collect_to_vec(&run_text(document, &mut provider, "groups"));
        assert_eq!(groups, expected, "{count} rays");
        assert!(u64::from(groups[0]) * u64::from(groups[1]) * 64 >= u64::from(count));
    }
}

#[test]
fn nested_triangles_of_all_sizes_are_told_apart() {
    // Each is twice as large and twice as far as the one before: the least balanced of trees.
    let (mut positions, mut triangles) = (vec![], vec![]);
    for level in 0..120u32 {
        let size = 2f32.powi(level as i32 - 60);
        positions.extend(
            [
                Vec3::new(-1.0, -1.0, 1.0),
                Vec3::new(1.0, -1.0, 1.0),
                Vec3::new(0.0, 1.0, 1.0),
            ]
            .map(|p| p * size),
        );
        triangles.push([3 * level, 3 * level + 1, 3 * level + 2]);
    }
    let mesh = meshes::mesh(positions, triangles);
    let from = |level: i32| Ray {
        origin: Vec3::ZERO,
        t_min: 2f32.powi(level - 60),
        direction: Vec3::Z,
        t_max: 1e30,
    };
    let rays: Vec<Ray> = (-1..119).map(from).collect();
    for (level, hit) in trace_all(&mesh, &rays, "Closest").iter().enumerate() {
        assert_eq!(
            (hit.primitive, hit.t),
            (level as u32, 2f32.powi(level as i32 - 60))
        );
    }
}

/// The primitive of a ray whose way the driver broke off.
const UNANSWERED: u32 = 0xffff_fffd;

/// Sheets over each other, whose boxes all hold a ray up that none of them holds, and one at each
/// end that does: the first primitive at the bottom, the last at the top.
fn stack(sheets: u32) -> Mesh {
    let corners = |number: u32| {
        // A hierarchy of pairs that are all alike takes long to build.
        let [a, b, c] = [0.618, 0.755, 0.57].map(|step| (number as f32 * step).fract());
        let y = (number as f32 + a / 2.0) / (sheets + 1) as f32;
        let is_end = number.is_multiple_of(sheets + 1);
        let end = if is_end { 4.0 } else { 0.5 };
        [(1.0, -1.0), (-1.0, -1.0), (-1.0, end)]
            .map(|(x, z)| Vec3::new(x + b / 10.0, y, z + c / 10.0))
    };
    let positions = (0..sheets + 2).flat_map(corners).collect();
    let triangles = (0..sheets + 2).map(|number| [0, 1, 2].map(|corner| 3 * number + corner));
    meshes::mesh(positions, triangles.collect())
}

/// Drivers may end loops without a word; lavapipe does.
#[test]
fn a_way_that_is_broken_off_has_no_answer() {
    let up = |y: f32| Ray {
        origin: Vec3::new(0.0, y, 0.0),
        t_min: 0.0,
        direction: Vec3::Y,
        t_max: 10.0,
    };
    let beside = Ray {
        origin: Vec3::new(0.0, -0.5, 100.0),
        ..up(0.0)
    };
    let mut is_broken_off = false;
    for sheets in [1_000, 150_000] {
        let mesh = stack(sheets);
        // From below through all of them to the first, and from above the first to the last; two
        // groups of rays beside them all.
        let mut rays = vec![up(-0.5), up(0.3 / (sheets + 1) as f32)];
        rays.resize(192, beside);
        for fields in [
            "mode: Any",
            "mode: Closest",
            r#"mode: Any, engine: LightSpace, direction: Light"#,
            r#"mode: Closest, engine: LightSpace, direction: Light"#,
        ] {
            let hits = trace_by(fields, DVec3::NEG_Y, &mesh, &rays, None, rays.len() as u32);
            let primitives = [hits[0], hits[1]].map(|hit| hit.primitive);
            println!("{sheets} sheets, {fields}: {primitives:?}");
            for (primitive, right) in primitives.into_iter().zip([0, sheets + 1]) {
                let is_any = primitive == sheets + 1 && fields.starts_with("mode: Any");
                let is_unanswered = primitive == UNANSWERED && sheets > 1_000;
                assert!(
                    primitive == right || is_any || is_unanswered,
                    "{fields}: {primitives:?}"
                );
                is_broken_off |= is_unanswered;
            }
            assert!(
                hits[64..].iter().all(|hit| hit.primitive == MISS),
                "{fields}"
            );
        }
    }
    println!("ways are broken off: {is_broken_off}");
}

/// A floor below the sheets instead of the lowest one.
#[test]
fn a_pixel_without_an_answer_is_neither_lit_nor_judged() {
    let mut mesh = stack(150_000);
    mesh.positions[..3].copy_from_slice(
        &[(90.0, -40.0), (-40.0, -40.0), (-40.0, 90.0)].map(|(x, z)| Vec3::new(x, -1.0, z)),
    );
    let view = View {
        eye: DVec3::new(0.0, -0.3, 3.0),
        direction: DVec3::new(0.0, -0.7, -3.0),
        far: 200.0,
        ..View::default()
    };
    let scene = Arc::new(Scene {
        name: "stack".into(),
        mesh: meshes::mesh(mesh.positions, mesh.triangles),
        views: vec![view.clone()],
        lights: vec![DirectionalLight::new(DVec3::NEG_Y).into()],
    });
    let viewport = [32, 32];
    let mut provider = graphs::provider(&scene, &view, viewport);
    let plan = graphs::plan("pipelines/rt.ron", &provider, viewport, |request| {
        request.captures.push(Capture::new("primitive"));
    });
    let report = graphs::run(plan, &mut provider, &["visibility", "status", "primitive"]);
    let [visibility, status, primitives] =
        ["visibility", "status", "primitive"].map(|name| graphs::values(&report, name));
    let oracle = Oracle::new(&scene.mesh);
    let truth = oracle.shade(
        &view.camera(viewport),
        scene.light(),
        &primitives,
        OracleMode::Exact,
        Progress::default(),
    );
    let truth = truth.unwrap();
    let is_unanswered = |shown: &&u32| **shown == statistics::UNANSWERED;
    let unanswered = visibility.iter().filter(is_unanswered).count();
    match Statistics::judged(&visibility, &status, &truth) {
        Err(Error::Unanswered { pixels, .. }) => assert_eq!(pixels, unanswered),
        judged => assert_eq!((judged.unwrap().wrong.total, unanswered), (0, 0)),
    }
    // Those that have one have the right one.
    let (mut wrong, mut in_shadow) = (0, 0);
    for ((&shown, right), &status) in visibility.iter().zip(truth.visibility()).zip(&status) {
        let is_answered = status == 4 && shown != statistics::UNANSWERED;
        in_shadow += usize::from(is_answered && right == 0);
        wrong += usize::from(is_answered && shown != u32::from(right));
    }
    println!("{unanswered} unanswered, {in_shadow} in shadow, {wrong} wrong");
    assert_eq!(wrong, 0);
    let all_in_shadow = unanswered + in_shadow;
    assert!((50..1000).contains(&all_in_shadow), "{all_in_shadow}");
}
