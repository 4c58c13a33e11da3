//! Lights that have an extent: the presets that sample them against the oracle.

use crate::support;
use crate::support::graphs::{layered, open, plan_files, plan_with, provider, run, values};
use glam::{DVec3, Vec3};
use skiagraph_gpu::{ExecuteError, Executor};
use skiagraph_graph::{Capture, PassSummary};
use skiagraph_reference::{Class, Graded, GroundTruth, Oracle, OracleMode, Progress, area};
use skiagraph_scene::{DirectionalLight, LightKind, Mesh, PointLight, Scene, SpotLight, View};
use std::sync::Arc;

const VIEWPORT: [u32; 2] = [64, 48];

/// A thin plate above a floor.
fn scene(light: impl Into<LightKind>) -> Arc<Scene> {
    let mesh = support::meshes::box_over_floor(6.0, Vec3::new(1.2, 0.2, 1.1));
    scene_of(mesh, light)
}

fn scene_of(mesh: Mesh, light: impl Into<LightKind>) -> Arc<Scene> {
    let view = View {
        eye: DVec3::new(0.5, 6.0, 7.0),
        direction: DVec3::new(0.0, -0.8, -1.0),
        fov_y_degrees: 50.0,
        near: 0.5,
        far: 50.0,
        ..View::default()
    };
    let light = skiagraph_scene::Light::only(light);
    Arc::new(Scene {
        name: "test".into(),
        mesh,
        views: vec![view],
        lights: vec![light],
    })
}

fn sun(angle_degrees: f64) -> DirectionalLight {
    DirectionalLight {
        direction: DVec3::new(-0.4, -1.0, 0.3),
        angle_degrees,
    }
}

/// Picture of a document, and its rays and passes.
struct Shown {
    shares: Vec<f32>,
    status: Vec<u32>,
    rays: u32,
    traces: usize,
    /// Receivers that all casters were tested for.
    unlisted: usize,
}

fn shown(document: &str, scene: &Arc<Scene>) -> Shown {
    let mut provider = provider(scene, &scene.views[0], VIEWPORT);
    let is_listed = document.contains("unlisted\": receivers");
    let names = ["visibility", "status", "ray_count", "pending_state"];
    let files = layered(&[("test.ron", document)]);
    let plan = plan_with(&files, "test.ron", &provider, VIEWPORT, |request| {
        let state = is_listed.then(|| Capture::new("pending_state"));
        request.captures.extend(state);
    });
    let is_trace = |pass: &&PassSummary| pass.name.ends_with("trace_rays");
    let traces = plan.passes().iter().filter(is_trace).count();
    let report = run(plan, &mut provider, &names[..if is_listed { 4 } else { 3 }]);
    let pending = if is_listed {
        values(&report, "pending_state")
    } else {
        vec![0; 3]
    };
    let visibility = report
        .readbacks
        .iter()
        .find(|read| read.name == "visibility");
    Shown {
        shares: visibility.and_then(|read| read.content.as_f32()).unwrap(),
        status: values(&report, "status"),
        rays: values(&report, "ray_count")[0],
        traces,
        // As shaders/shared/pending.wgsl has it: those with a place, and those without.
        unlisted: (pending[1] + pending[2]) as usize,
    }
}

fn preset(name: &str, set: &str) -> String {
    format!(
        r#"(format: 3, extends: "{name}.ron", lights: [directional, spot, point], set: {{{set}}})"#
    )
}

fn ground_truth(scene: &Scene) -> GroundTruth {
    let (oracle, camera) = (Oracle::new(&scene.mesh), scene.views[0].camera(VIEWPORT));
    let primitives = oracle.primary(&camera, Progress::default()).unwrap();
    let (how, progress) = ((OracleMode::Exact, 2048), Progress::default());
    let ground_truth =
        area::ground_truth(&oracle, &camera, scene.light(), &primitives, how, progress);
    ground_truth.unwrap()
}

fn judged(shown: &Shown, ground_truth: &GroundTruth) -> Graded {
    Graded::judged(&shown.shares, &ground_truth.shares(), &ground_truth.pixels).unwrap()
}

#[test]
#[ignore = "a suite: `./test.sh --all` runs it"]
fn samples_converge_to_the_oracles_shares_under_every_kind_of_light() {
    let spot = SpotLight {
        position: DVec3::new(1.5, 6.0, -1.0),
        direction: DVec3::new(-0.25, -1.0, 0.2),
        cone_degrees: 100.0,
        radius: 0.7,
    };
    let point = PointLight {
        position: DVec3::new(1.5, 6.0, -1.0),
        radius: 0.7,
    };
    for light in [
        LightKind::from(sun(12.0)),
        LightKind::Spot(spot),
        LightKind::Point(point),
    ] {
        let scene = scene(light);
        let ground_truth = ground_truth(&scene);
        let partial = ground_truth
            .shares()
            .iter()
            .filter(|share| (0.1..0.9).contains(*share))
            .count();
        assert!(
            partial > 40,
            "{}: {partial} pixels in penumbra",
            light.word()
        );
        let shown = [4, 32, 256].map(|samples| {
            let shown = shown(
                &preset("rt_area", &format!(r#""samples": {samples}"#)),
                &scene,
            );
            let facing = shown.status.iter().filter(|status| **status == 4).count();
            assert_eq!(shown.rays as usize, samples * facing);
            shown
        });
        // At an edge the oracle may see another primitive than the rasteriser.
        let mut ground_truth = ground_truth;
        let classes = ground_truth.pixels.classes.iter_mut();
        let shares = ground_truth.area.as_ref().unwrap().shares.iter();
        let pixels = classes.zip(shares.zip(&shown[2].shares));
        let disputed = pixels
            .filter(|(class, (share, shown))| class.faces_light() && (*share - *shown).abs() > 0.3);
        let disputed = disputed
            .map(|(class, _)| *class = Class::Background)
            .count();
        assert!(disputed * 100 < shown[2].shares.len(), "{disputed} pixels");
        let rmse = shown
            .each_ref()
            .map(|shown| judged(shown, &ground_truth).rmse);
        // Strata of a straight edge: better than the square root, by which eight times as many
        // would leave 0.35.
        assert!(
            rmse[1] < 0.33 * rmse[0] && rmse[2] < 0.33 * rmse[1] && rmse[2] < 0.01,
            "{}: {rmse:?}",
            light.word()
        );
    }
}

#[test]
fn without_extent_one_ray_decides_as_in_rt() {
    let scene = scene(sun(0.0));
    let soft = shown(&preset("rt_area", r#""samples": 64"#), &scene);
    let mut provider = provider(&scene, &scene.views[0], VIEWPORT);
    let plan = plan_files(&[("test.ron", &preset("rt", ""))], &provider, VIEWPORT);
    let report = run(plan, &mut provider, &["visibility", "status", "ray_count"]);
    let hard: Vec<f32> = values(&report, "visibility")
        .iter()
        .map(|&lit| lit as f32)
        .collect();
    assert_eq!(soft.shares, hard);
    assert_eq!(soft.status, values(&report, "status"));
    assert_eq!(soft.rays, values(&report, "ray_count")[0]);
    assert!(hard.iter().filter(|share| **share == 0.0).count() > 100);
}

#[test]
#[ignore = "a suite: `./test.sh --all` runs it"]
fn samples_and_pixels_in_turns_show_what_they_show_at_once() {
    let scene = scene(sun(12.0));
    let at = |most_rays: u32| {
        let document = format!(
            r#"(
                format: 3,
                extends: "rt_area.ron",
                set: {{"samples": 23}},
                passes: [Change(pass: "sample_light", set: {{"most_rays": {most_rays}}})],
            )"#
        );
        shown(&document, &scene)
    };
    let once = at(1 << 22);
    // 3,072 pixels: five samples at a time; then one sample of all pixels, the least there is.
    for (most_rays, traces) in [(16_000, 5), (1_000, 23)] {
        let turns = at(most_rays);
        assert_eq!((once.traces, turns.traces), (1, traces));
        assert_eq!(turns.shares, once.shares, "{most_rays}");
        assert_eq!(turns.rays, once.rays);
    }
}

#[test]
fn eight_maps_agree_in_light_and_umbra_and_leave_the_penumbra_to_rays() {
    let scene = scene(sun(12.0));
    let ground_truth = ground_truth(&scene);
    let set = r#""map_size": 256, "samples": 64"#;
    let hybrid = shown(
        &preset("hybrid_pcf_area", set).replace(", spot, point", ""),
        &scene,
    );
    let traced = shown(&preset("rt_area", r#""samples": 64"#), &scene);
    assert!(
        hybrid.rays < traced.rays / 2,
        "{} of {}",
        hybrid.rays,
        traced.rays
    );
    let shares = ground_truth.shares();
    for (status, share) in [(2, 1.0), (3, 0.0)] {
        let certain = hybrid
            .status
            .iter()
            .enumerate()
            .filter(|(_, is)| **is == status);
        let pixels: Vec<usize> = certain.map(|(pixel, _)| pixel).collect();
        assert!(pixels.len() > 20, "{} of status {status}", pixels.len());
        assert!(pixels.iter().all(|&pixel| hybrid.shares[pixel] == share));
        // Certain pixels are in no penumbra, but for errors between eight points.
        let wrong = pixels
            .iter()
            .filter(|&&pixel| (shares[pixel] - share).abs() > 0.05);
        assert!(wrong.count() * 20 < pixels.len());
    }
    // Where it asks, it asks the rays that `rt_area` asks.
    let asked = hybrid
        .status
        .iter()
        .zip(hybrid.shares.iter().zip(&traced.shares));
    assert!(
        asked
            .filter(|(is, _)| **is == 4)
            .all(|(_, (one, other))| one == other)
    );
    let [hybrid, traced] = [&hybrid, &traced].map(|shown| judged(shown, &ground_truth).rmse);
    assert!(hybrid < traced + 0.03, "{hybrid} {traced}");
}

/// Lists beside rays: shares of every pixel, and the pixels without a list.
fn assert_lists_answer_as_rays_do(scene: &Arc<Scene>, samples: u32, set: &str) -> usize {
    let samples = format!(r#""samples": {samples}"#);
    let rays = shown(&preset("rt_area", &samples), scene);
    let lists = shown(
        &preset("light_buffer_area", &format!("{samples}{set}")),
        scene,
    );
    let bits = |shown: &Shown| -> Vec<u32> {
        let shares = shown.shares.iter();
        shares.map(|share| share.to_bits()).collect()
    };
    assert_eq!(bits(&lists), bits(&rays), "{samples}{set}");
    let is_partial = |share: &&f32| (0.01..0.99).contains(*share);
    assert!(rays.shares.iter().filter(is_partial).count() > 0);
    let unlisted = lists.status.iter().filter(|status| **status == 4).count();
    unlisted + lists.unlisted
}

#[test]
fn lists_answer_each_sample_as_its_ray_does() {
    for (angle, samples) in [(0.5, 64), (12.0, 7), (40.0, 64)] {
        let unlisted = assert_lists_answer_as_rays_do(&scene(sun(angle)), samples, "");
        assert_eq!(unlisted, 0, "{angle} degrees");
    }
}

#[test]
fn only_wide_suns_ask_for_a_hierarchy() {
    let (position, radius) = (DVec3::new(1.5, 6.0, -1.0), 0.7);
    let lamp = LightKind::Point(PointLight { position, radius });
    let suns = [(0.0, false), (2.2, false), (2.4, true)];
    let suns = suns.map(|(angle, is_wide)| (LightKind::from(sun(angle)), is_wide));
    for (light, is_wide) in [suns[0], suns[1], suns[2], (lamp, false)] {
        let scene = scene(light);
        let provider = provider(&scene, &scene.views[0], VIEWPORT);
        let document = preset("light_buffer_area", "");
        let plan = plan_files(&[("test.ron", &document)], &provider, VIEWPORT);
        let reads = plan.provided().contains(&"scene.bvh_nodes");
        assert_eq!(reads, is_wide, "{light:?}");
    }
}

#[test]
fn a_sun_that_becomes_wide_is_told_where_its_width_counts() {
    let (gpu, scene) = (open(), scene(sun(0.5)));
    for (method, counts) in [
        ("rt_area", false),
        ("pcss", false),
        ("light_buffer_area", true),
    ] {
        let mut provider = provider(&scene, &scene.views[0], VIEWPORT);
        let plan = plan_files(&[("test.ron", &preset(method, ""))], &provider, VIEWPORT);
        let mut executor = Executor::on(&gpu, plan, &mut provider).unwrap();
        for (angle, is_wide) in [(2.0, false), (5.0, true)] {
            provider.set_light(sun(angle).into());
            let error = executor.refresh(&mut provider).err();
            let is_told = matches!(
                &error,
                Some(ExecuteError::OtherThanPlanned { name, .. }) if name == "light_area"
            );
            assert_eq!(is_told, counts && is_wide, "{method}, {angle}: {error:?}");
            assert_eq!(error.is_some(), is_told, "{method}, {angle}: {error:?}");
        }
    }
}

#[test]
fn lists_answer_each_sample_of_lamps_as_its_ray_does() {
    let at = DVec3::new;
    let spot = |position, cone_degrees, radius| {
        LightKind::Spot(SpotLight {
            position,
            direction: at(-0.25, -1.0, 0.2),
            cone_degrees,
            radius,
        })
    };
    let point = |position, radius| LightKind::Point(PointLight { position, radius });
    // Above the plate; beside a corner of it, which several faces see, and through which the lamp
    // reaches; and so near to it that receivers lie within twice the lamp's radius.
    for (light, samples, asks) in [
        (spot(at(1.5, 6.0, -1.0), 100.0, 0.7), 64, false),
        (point(at(1.5, 6.0, -1.0), 0.7), 64, false),
        (point(at(1.5, 2.2, 1.4), 0.2), 16, false),
        (point(at(1.0, 1.9, 0.9), 0.4), 16, true),
        (spot(at(0.5, 2.4, 0.2), 170.0, 0.5), 16, true),
    ] {
        for word in ["receivers", "rays"] {
            let set = &format!(r#", "unlisted": {word}"#);
            let unlisted = assert_lists_answer_as_rays_do(&scene(light), samples, set);
            assert_eq!(
                unlisted > 0,
                asks,
                "{unlisted} pixels without a list: {light:?}"
            );
        }
    }
    // Over, and between, masked leaves.
    let leaves = || support::meshes::foliage(60, 0.35, 4.0, 1);
    for light in [
        spot(at(1.5, 6.0, -1.0), 100.0, 0.3),
        point(at(0.3, 1.0, 0.2), 0.1),
    ] {
        let set = r#", "unlisted": receivers"#;
        let unlisted = assert_lists_answer_as_rays_do(&scene_of(leaves(), light), 33, set);
        let pixels = (VIEWPORT[0] * VIEWPORT[1]) as usize;
        assert!(
            4 * unlisted < pixels,
            "{unlisted} of {pixels} without a list"
        );
    }
}

#[test]
#[ignore = "a suite: `./test.sh --all` runs it"]
fn lists_in_turns_and_lists_cut_short_answer_as_rays_do() {
    let scene = scene(sun(12.0));
    // More than a word of samples, and more than a turn.
    for samples in [33, 65, 256] {
        assert_eq!(assert_lists_answer_as_rays_do(&scene, samples, ""), 0);
    }
    // With one caster at most in a list, or one entry in all of them.
    for short in ["longest_list\": 0", "longest_list\": 1", "max_entries\": 1"] {
        for word in ["receivers", "rays"] {
            let set = format!(r#", "{short}, "unlisted": {word}"#);
            for samples in [16, 100] {
                let unlisted = assert_lists_answer_as_rays_do(&scene, samples, &set);
                assert!(unlisted > 20, "{set}");
            }
        }
    }
    for fit in ["scene", "camera", "pssm"] {
        let unlisted = assert_lists_answer_as_rays_do(&scene, 16, &format!(r#", "fit": {fit}"#));
        assert_eq!(unlisted, 0, "{fit}");
    }
}

#[test]
fn without_extent_lists_answer_as_those_of_hard_shadows() {
    let (position, radius) = (DVec3::new(1.5, 2.2, 1.4), 0.0);
    let point = LightKind::Point(PointLight { position, radius });
    for light in [LightKind::from(sun(0.0)), point] {
        let scene = scene(light);
        let soft = shown(&preset("light_buffer_area", r#""samples": 64"#), &scene);
        let mut provider = provider(&scene, &scene.views[0], VIEWPORT);
        let hard = preset("light_buffer", "");
        let plan = plan_files(&[("test.ron", &hard)], &provider, VIEWPORT);
        let report = run(plan, &mut provider, &["visibility", "status"]);
        let hard = values(&report, "visibility");
        let hard: Vec<f32> = hard.iter().map(|&lit| lit as f32).collect();
        assert_eq!(soft.shares, hard);
        assert_eq!(soft.status, values(&report, "status"));
        assert!(hard.iter().filter(|share| **share == 0.0).count() > 100);
    }
}
