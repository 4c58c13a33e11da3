//! Where shadow maps lie: over the scene, what the eye could see, or the receivers that it does
//! see; and that what is proven of a map does not depend on it.

use crate::support::{
    bench::Bench,
    graphs::{frame, open, plan, provider, values},
    map_fit::MapFit,
    meshes::{joined, mesh, potato},
};
use glam::{DVec2, DVec3, Vec3};
use skiagraph_gpu::Executor;
use skiagraph_graph::{Capture, ParamValue};
use skiagraph_scene::{DirectionalLight, Scene, View};
use std::sync::Arc;

const VIEWPORT: [u32; 2] = [96, 64];
const LIGHT: DVec3 = DVec3::new(0.4, -1.0, 0.3);

/// A potato over a floor twelve times as wide, seen from aside.
fn scene(seed: u64, far: f64) -> Arc<Scene> {
    let corners = [(-12.0, 12.0), (12.0, 12.0), (12.0, -12.0), (-12.0, -12.0)];
    let corners = corners.map(|(x, z)| Vec3::new(x, -1.5, z)).to_vec();
    let floor = mesh(corners, vec![[0, 1, 2], [0, 2, 3]]);
    let eye = DVec3::new(2.0, 3.0, 4.0);
    let view = View {
        eye,
        direction: -eye,
        fov_y_degrees: 40.0,
        near: 0.5,
        far,
        ..View::default()
    };
    Arc::new(Scene {
        name: "test".into(),
        mesh: joined(potato(4, 0.3, seed), &floor),
        views: vec![view],
        lights: vec![DirectionalLight::new(LIGHT).into()],
    })
}

fn word(word: &str) -> ParamValue {
    ParamValue::Choice(word.to_owned())
}

/// The map of a preset, and the places in it of the receivers that face the light.
fn map_of(scene: &Arc<Scene>, preset: &str, fit: &str, distance: f32) -> (MapFit, Vec<DVec2>) {
    let gpu = open();
    let mut provider = provider(scene, &scene.views[0], VIEWPORT);
    let captured = ["map_fit", "position"];
    let path = format!("pipelines/{preset}.ron");
    let plan = plan(&path, &provider, VIEWPORT, |request| {
        request.params.extend([
            ("fit".to_owned(), word(fit)),
            ("fit_distance".to_owned(), ParamValue::F32(distance)),
            ("map_size".to_owned(), ParamValue::U32(100)),
        ]);
        let captures = captured.map(Capture::new);
        request.captures.extend(captures);
    });
    let mut executor = Executor::on(&gpu, plan, &mut provider).unwrap();
    let report = frame(&gpu, &mut executor, &captured);
    let map = MapFit::new(&report, scene);
    let positions = report
        .readbacks
        .iter()
        .find(|readback| readback.name == "position");
    let positions = positions.unwrap().content.as_f32().unwrap();
    let facing = positions.chunks_exact(4).filter(|texel| texel[3] > 0.0);
    let places = facing.map(|texel| map.texel(Vec3::from_slice(texel).as_dvec3()).truncate());
    let places = places.collect();
    (map, places)
}

fn bounds(places: impl IntoIterator<Item = DVec2>) -> (DVec2, DVec2) {
    let empty = (DVec2::MAX, DVec2::MIN);
    let grow = |(low, high): (DVec2, DVec2), place| (low.min(place), high.max(place));
    places.into_iter().fold(empty, grow)
}

/// Upright as seen from the light, and just around the eight corners of what the eye could see.
#[test]
fn a_map_over_the_eye_is_the_rectangle_around_its_frustum() {
    for (seed, far, distance) in [(1, 9.0, 0.0), (2, 30.0, 0.0), (3, 30.0, 6.0)] {
        let scene = scene(seed, far);
        let (map, receivers) = map_of(&scene, "crsm", "camera", distance);
        let camera = scene.views[0].camera(VIEWPORT);
        let end = if distance > 0.0 { distance.into() } else { far };
        let corners = [(-1.0, -1.0), (1.0, -1.0), (-1.0, 1.0), (1.0, 1.0)].map(|(x, y)| {
            camera.forward
                + x * camera.half_width * camera.right
                + y * camera.half_height * camera.up
        });
        let corners = [camera.near, end].map(|z| corners.map(|way| camera.eye + z * way));
        let (low, high) = bounds(
            corners
                .into_iter()
                .flatten()
                .map(|p| map.texel(p).truncate()),
        );
        assert!(low.abs().max_element() < 0.01, "{low}");
        assert!((high - 100.0).abs().max_element() < 0.01, "{high}");
        // A step up, as seen from the light, is one up in the map.
        let forward = LIGHT.normalize();
        let up = DVec3::Y - forward * forward.y;
        let step = map.texel(up) - map.texel(DVec3::ZERO);
        assert!(step.x.abs() < 1e-3 && step.y < 0.0, "{step}");
        let (low, high) = bounds(receivers);
        let inside = low.min_element() >= -0.01 && high.max_element() <= 100.01;
        assert_eq!(inside, distance == 0.0, "{low} {high}");
    }
}

#[test]
fn a_map_over_the_receivers_is_as_small_as_holds_them() {
    for preset in ["nsm", "hybrid_pcf", "crsm"] {
        let (_, over_scene) = map_of(&scene(4, 30.0), preset, "scene", 0.0);
        let (_, receivers) = map_of(&scene(4, 30.0), preset, "receivers", 0.0);
        let (low, high) = bounds(over_scene);
        assert!((high - low).max_element() < 70.0, "{low} {high}");
        let (low, high) = bounds(receivers);
        assert!(
            low.min_element() >= 0.0 && high.max_element() < 100.0,
            "{low} {high}"
        );
        assert!((high - low).min_element() > 90.0, "{low} {high}");
    }
}

/// Also where receivers lie outside of the map.
#[test]
#[ignore = "a suite: `./test.sh --all` runs it"]
fn what_is_proven_does_not_depend_on_where_the_map_lies() {
    for seed in 0..4 {
        let scene = scene(seed, 30.0);
        let mut bench = Bench::new(&scene, VIEWPORT);
        for preset in ["crsm", "crsm_depth", "crsma_full", "light_buffer"] {
            let mut uncertain = Vec::new();
            for (fit, distance) in [
                ("scene", 0.0),
                ("camera", 0.0),
                ("camera", 5.0),
                ("receivers", 0.0),
                ("pssm", 0.0),
                ("pssm", 5.0),
            ] {
                let params = [
                    ("fit", word(fit)),
                    ("fit_distance", ParamValue::F32(distance)),
                    ("map_size", ParamValue::U32(64)),
                    ("splits", ParamValue::U32(3)),
                    ("fit_to_receivers", ParamValue::Bool(seed % 2 == 1)),
                ];
                let counts = bench.judge(preset, &params);
                assert_eq!(
                    counts.wrong.total, counts.wrong.in_band,
                    "{preset} {fit} {distance}"
                );
                assert!(
                    counts.pixels.lit > 1000 && counts.pixels.shadow > 300,
                    "{counts:?}"
                );
                uncertain.push(counts.uncertain);
            }
            if preset == "light_buffer" {
                assert_eq!([0, 1, 3, 4].map(|fit| uncertain[fit]), [0; 4]);
                assert_eq!(uncertain[2], 0, "what is outside is tested apart");
            } else {
                assert!(uncertain[3] < uncertain[0], "{preset}: {uncertain:?}");
            }
        }
    }
}

/// Texels that are too small for f32 are not asked for, so that receivers far from the origin are
/// not uncertain all.
#[test]
fn far_from_the_origin_texels_are_larger() {
    let mut far_off = (*scene(5, 30.0)).clone();
    let by = Vec3::new(3e3, -2e3, 4e3);
    far_off.mesh.positions.iter_mut().for_each(|p| *p += by);
    far_off.views[0].eye += by.as_dvec3();
    let far_off = Arc::new(far_off);
    let mut bench = Bench::new(&far_off, VIEWPORT);
    for fit in ["scene", "camera", "receivers", "pssm"] {
        let params = [("fit", word(fit)), ("map_size", ParamValue::U32(8192))];
        let counts = bench.judge("crsm", &params);
        assert_eq!(
            counts.wrong.total, counts.wrong.in_band,
            "{fit}: {counts:?}"
        );
        assert!(
            counts.uncertain * 2 < counts.pixels.facing_light,
            "{fit}: {counts:?}"
        );
    }
}

/// A map that depends on what is seen is drawn anew when something else is.
#[test]
fn a_map_over_the_receivers_follows_them() {
    let gpu = open();
    let near = scene(6, 30.0);
    let mut away = near.views[0].clone();
    away.eye += DVec3::new(1.0, 0.5, -0.5);
    let outputs = ["visibility", "status"];
    let start = |view: &View| {
        let mut provider = provider(&near, view, VIEWPORT);
        let plan = plan("pipelines/nsm.ron", &provider, VIEWPORT, |request| {
            request.params.insert("fit".to_owned(), word("receivers"));
        });
        let executor = Executor::on(&gpu, plan, &mut provider).unwrap();
        (executor, provider)
    };
    let (mut executor, mut provider) = start(&near.views[0]);
    let first = frame(&gpu, &mut executor, &outputs);
    provider.set_view(&away, VIEWPORT);
    executor.refresh(&mut provider).unwrap();
    let moved = frame(&gpu, &mut executor, &outputs);
    let anew = frame(&gpu, &mut start(&away).0, &outputs);
    assert_ne!(values(&moved, "visibility"), values(&first, "visibility"));
    assert_eq!(values(&moved, "visibility"), values(&anew, "visibility"));
}
