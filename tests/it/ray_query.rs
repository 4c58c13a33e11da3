//! `Trace` by the device's own ray queries, held against the compute hierarchy and the f64 oracle.
//!
//! A suite of its own, for an adapter with `EXPERIMENTAL_RAY_QUERY`: without one each of these
//! tests fails, and a plain `cargo test` leaves them out and says so. `.ci/run` gives it Mesa 25:
//! `env $(scripts/mesa25.sh) cargo test -p skiagraph-tests --test across -- --ignored ray_query`

use crate::support::{
    bench::Bench,
    brute::{Hit, MISS, Ray},
    graphs::{self, RAY_QUERY, frame, open, plan, trace_by, values},
    meshes,
    random::Random,
    scenes::load,
};
use glam::{DAffine3, DVec3, Vec3};
use skiagraph_gpu::Executor;
use skiagraph_graph::ParamValue;
use skiagraph_passes::SceneProvider;
use skiagraph_scene::{Mesh, Movable, Scene};
use std::sync::Arc;

/// No more of all pixels, and of random rays, may be answered in another way.
const MOST: f64 = 1e-4;

fn traced(engine: &str, mode: &str, mesh: &Mesh, rays: &[Ray], skip: Option<&[u32]>) -> Vec<Hit> {
    assert!(
        open().device.features().contains(RAY_QUERY),
        "this adapter has no EXPERIMENTAL_RAY_QUERY, which this suite is about"
    );
    let fields = format!("mode: {mode}, engine: {engine}");
    trace_by(&fields, DVec3::NEG_Y, mesh, rays, skip, rays.len() as u32)
}

/// Holds `rt` by ray queries against `rt` by the hierarchy, pixel by pixel, and against the oracle.
fn rt_answers_alike(scene: &Arc<Scene>, viewport: [u32; 2]) {
    let mut bench = Bench::new(scene, viewport);
    assert!(
        bench.gpu.device.features().contains(RAY_QUERY),
        "this adapter has no EXPERIMENTAL_RAY_QUERY, which this suite is about"
    );
    let mut by = |engine: &str| {
        let engine = ParamValue::Choice(engine.to_owned());
        bench.answers("rt", &[("engine", engine)])
    };
    let (ours, theirs) = (by("hierarchy"), by("ray_query"));
    let pixels = ours.visibility.len();
    let differing: Vec<usize> = (0..pixels)
        .filter(|&pixel| ours.visibility[pixel] != theirs.visibility[pixel])
        .collect();
    let outside: Vec<[usize; 2]> = differing
        .iter()
        .filter(|&&pixel| !ours.truth.indeterminate[pixel])
        .map(|pixel| [pixel % viewport[0] as usize, pixel / viewport[0] as usize])
        .collect();
    println!(
        "{}: {} of {pixels} pixels differ, {} of them determinate: {outside:?}",
        scene.name,
        differing.len(),
        outside.len()
    );
    assert!(theirs.counts.pixels.shadow > 0 && theirs.counts.pixels.lit > 0);
    assert!(differing.len() as f64 <= MOST * pixels as f64);
    assert!(outside.is_empty(), "{outside:?}");
}

#[test]
#[ignore = "an adapter with ray queries: `.ci/run` runs it on Mesa 25"]
fn rt_on_sponza_answers_alike() {
    rt_answers_alike(&load("sponza"), [512, 512]);
}

#[test]
#[ignore = "an adapter with ray queries: `.ci/run` runs it on Mesa 25"]
fn rt_on_park_answers_alike() {
    rt_answers_alike(&load("park"), [512, 384]);
}

#[test]
#[ignore = "an adapter with ray queries: `.ci/run` runs it on Mesa 25"]
fn a_deformed_mesh_has_a_structure_of_its_own() {
    let (scene, viewport) = (load("park"), [192, 144]);
    let movable = Movable::new(&scene.mesh, &["tree 1"]).unwrap();
    let scene = Arc::new(Scene {
        mesh: movable.rest.clone(),
        ..(*scene).clone()
    });
    let view = scene
        .views
        .iter()
        .find(|view| view.name == "trees_side")
        .unwrap();
    let gpu = open();
    let start = |provider: &mut SceneProvider| {
        let plan = plan("pipelines/rt.ron", provider, viewport, |request| {
            graphs::allow_ray_queries(request);
            let engine = ParamValue::Choice("ray_query".to_owned());
            request.params.insert("engine".to_owned(), engine);
        });
        Executor::on(&gpu, plan, provider).unwrap()
    };
    let visible = |executor: &mut Executor| {
        let report = frame(&gpu, executor, &["visibility"]);
        values(&report, "visibility")
    };
    let mut provider = graphs::provider(&scene, view, viewport);
    provider.set_parts(movable);
    let mut executor = start(&mut provider);
    let before = visible(&mut executor);
    let shift = DAffine3::from_translation(DVec3::new(3.0, 1.0, -2.0));
    provider.set_transforms(&[shift]).unwrap();
    executor.refresh(&mut provider).unwrap();
    let after = visible(&mut executor);
    let mut anew = graphs::provider(provider.scene(), view, viewport);
    assert_eq!(after, visible(&mut start(&mut anew)));
    assert_ne!(after, before);
}

#[test]
#[ignore = "an adapter with ray queries: `.ci/run` runs it on Mesa 25"]
fn random_rays_hit_the_same() {
    let mesh = meshes::soup(3000, 0.1, 1);
    let mut random = Random(2);
    let rays: Vec<Ray> = (0..100_000)
        .map(|_| Ray {
            origin: random.vector() * 2.0,
            t_min: 0.0,
            direction: random.vector(),
            t_max: 4.0 * random.unit(),
        })
        .collect();
    let closest = ["Hierarchy", "RayQuery"].map(|by| traced(by, "Closest", &mesh, &rays, None));
    let any = traced("RayQuery", "Any", &mesh, &rays, None);
    let (mut hits, mut differing, mut rounded) = (0, 0, 0);
    for ((ours, theirs), any) in closest[0].iter().zip(&closest[1]).zip(&any) {
        hits += usize::from(ours.primitive != MISS);
        let near = |a: f32, b: f32| (a - b).abs() < 1e-3;
        let same = ours.primitive == theirs.primitive
            && near(ours.t, theirs.t)
            && near(ours.u, theirs.u)
            && near(ours.v, theirs.v)
            && (any.primitive == MISS) == (ours.primitive == MISS);
        differing += usize::from(!same);
        rounded += usize::from(ours.t.to_bits() != theirs.t.to_bits());
    }
    println!(
        "{hits} of {} rays hit, {differing} differ; {rounded} distances are rounded otherwise",
        rays.len()
    );
    assert!(hits > 10_000, "{hits} hits: too few to mean anything");
    assert!(differing as f64 <= MOST * rays.len() as f64, "{differing}");
    // Past what each hits first, the next.
    let skip: Vec<u32> = closest[0].iter().map(|hit| hit.primitive).collect();
    let past = ["Hierarchy", "RayQuery"].map(|by| traced(by, "Closest", &mesh, &rays, Some(&skip)));
    let next = past[1].iter().filter(|hit| hit.primitive != MISS).count();
    assert!(next > 1000, "{next} second hits: too few to mean anything");
    for ((hit, skipped), ours) in past[1].iter().zip(&skip).zip(&past[0]) {
        assert!(hit.primitive == MISS || hit.primitive != *skipped);
        differing += usize::from(hit.primitive != ours.primitive);
    }
    assert!(
        differing as f64 <= 2.0 * MOST * rays.len() as f64,
        "{differing}"
    );
}

#[test]
#[ignore = "an adapter with ray queries: `.ci/run` runs it on Mesa 25"]
fn intervals_and_empty_scenes() {
    let corners = [[-1.0, -1.0, 2.0], [3.0, -1.0, 2.0], [-1.0, 3.0, 2.0]];
    let mesh = meshes::mesh(corners.map(Vec3::from).to_vec(), vec![[0, 1, 2]]);
    let ray = |t_min, t_max, direction| Ray {
        origin: Vec3::ZERO,
        t_min,
        direction,
        t_max,
    };
    let rays = [
        ray(0.0, 10.0, Vec3::Z),
        ray(0.0, 1.0, Vec3::Z * 4.0),
        ray(2.0, 10.0, Vec3::Z),
        ray(1.9, 10.0, Vec3::Z),
        ray(0.0, 1.9, Vec3::Z),
        ray(10.0, 0.0, Vec3::Z),
        ray(0.0, 10.0, Vec3::ZERO),
        ray(0.0, 10.0, Vec3::NEG_Z),
        ray(0.0, 10.0, Vec3::splat(f32::NAN)),
        ray(-1.0, 10.0, Vec3::Z),
    ];
    let hits = traced("RayQuery", "Closest", &mesh, &rays, None);
    let hit_flags: Vec<bool> = hits.iter().map(|hit| hit.primitive == 0).collect();
    assert_eq!(
        hit_flags,
        [
            true, true, false, true, false, false, false, false, false, false
        ],
        "{hits:?}"
    );
    let hit = Hit {
        t: 2.0,
        primitive: 0,
        u: 0.25,
        v: 0.25,
    };
    assert_eq!(hits[0], hit);
    assert_eq!((hits[4].t, hits[4].primitive), (1.9, MISS));
    for hit in traced("RayQuery", "Any", &Mesh::default(), &rays, None) {
        assert_eq!(hit.primitive, MISS);
    }
}
