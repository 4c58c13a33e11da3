//! Filtered shadow maps: `pcf`, `vsm`, `esm`. Each shows its known artefact on the case made for
//! it, and less of it by the param that is meant against it.

use crate::support::{
    graphs::{open, plan, provider, run_on, shares, values},
    meshes::foliage,
};
use glam::{DVec3, Vec3};
use skiagraph_graph::{Capture, ParamValue};
use skiagraph_reference::{Class, Oracle, OracleMode, Progress, ground_truth};
use skiagraph_scene::{DirectionalLight, LightKind, PointLight, Scene, SpotLight};
use std::sync::Arc;

const VIEWPORT: [u32; 2] = [128, 128];

type Params<'a> = &'a [(&'a str, ParamValue)];

/// Answers of a preset per pixel, and the truth.
struct Seen {
    visibility: Vec<f32>,
    position: Vec<Vec3>,
    classes: Vec<Class>,
}

fn case(name: &str) -> Arc<Scene> {
    Arc::new(skiagraph_cases::case(name).unwrap().scene())
}

fn see(scene: &Arc<Scene>, preset: &str, params: Params) -> Seen {
    let gpu = open();
    let mut provider = provider(scene, &scene.views[0], VIEWPORT);
    let path = format!("pipelines/{preset}.ron");
    let captured = ["primitive", "position"];
    let plan = plan(&path, &provider, VIEWPORT, |request| {
        request.features = gpu.device.features() & wgpu::Features::FLOAT32_FILTERABLE;
        request.captures = captured
            .map(|material| Capture {
                material: material.into(),
                after: None,
            })
            .into();
        let params = params.iter().cloned();
        request
            .params
            .extend(params.map(|(name, value)| (name.to_owned(), value)));
    });
    let names = ["visibility", "primitive", "position"];
    let report = run_on(&gpu, plan, &mut provider, &names);
    let visibility = shares(&report, "visibility");
    let inside = |share: &f32| (0.0..=1.0).contains(share);
    assert!(visibility.iter().all(inside), "{preset} {params:?}");
    let oracle = Oracle::new(&scene.mesh);
    let camera = scene.views[0].camera(VIEWPORT);
    let (primitives, mode) = (values(&report, "primitive"), OracleMode::Exact);
    let light = scene.light();
    let shaded = oracle.shade(&camera, light, &primitives, mode, Progress::default());
    Seen {
        visibility,
        position: shares(&report, "position")
            .chunks_exact(4)
            .map(Vec3::from_slice)
            .collect(),
        classes: shaded.unwrap().classes,
    }
}

impl Seen {
    /// Pixels all around which, so many pixels far, is the same answer of the oracle.
    fn inside(&self, class: Class, by: i32) -> Vec<usize> {
        let [width, height] = VIEWPORT.map(|edge| edge as i32);
        let is_class = |x: i32, y: i32| {
            let within = (0..width).contains(&x) && (0..height).contains(&y);
            within && self.classes[(y * width + x) as usize] == class
        };
        (0..width * height)
            .filter(|pixel| {
                let (x, y) = (pixel % width, pixel / width);
                (y - by..=y + by).all(|y| (x - by..=x + by).all(|x| is_class(x, y)))
            })
            .map(|pixel| pixel as usize)
            .collect()
    }

    /// Counts the pixels well inside of shadows that get more light than this.
    fn leaks(&self, by: i32, more_than: f32) -> usize {
        let pixels = self.inside(Class::Shadow, by);
        assert!(pixels.len() > 1000, "{} in shadow", pixels.len());
        let lit = |pixel: &&usize| self.visibility[**pixel] > more_than;
        pixels.iter().filter(lit).count()
    }
}

fn map(size: u32) -> (&'static str, ParamValue) {
    ("map_size", ParamValue::U32(size))
}

fn float(name: &str, value: f32) -> (&str, ParamValue) {
    (name, ParamValue::F32(value))
}

fn number(name: &str, value: u32) -> (&str, ParamValue) {
    (name, ParamValue::U32(value))
}

#[test]
fn vsm_bleeds_behind_two_occluders_and_less_when_it_is_cut() {
    let scene = case("two_occluders");
    let leaks = |preset: &str, params: Params| see(&scene, preset, params).leaks(4, 0.1);
    let bleeding = [0.0, 0.2, 0.6].map(|cut| {
        leaks(
            "vsm",
            &[map(512), number("radius", 4), float("bleed_reduction", cut)],
        )
    });
    println!("vsm leaks at {bleeding:?} pixels");
    assert!(bleeding[0] > 50, "{bleeding:?}");
    assert!(
        bleeding[1] < bleeding[0] && bleeding[2] * 10 < bleeding[0],
        "{bleeding:?}"
    );
    // A filter that compares with every depth does not leak.
    let compared = leaks("pcf", &[map(512), number("radius", 4)]);
    assert_eq!(compared, 0);
}

#[test]
fn esm_fails_at_contact_and_less_with_a_greater_exponent() {
    let scene = case("contact");
    let leaks = |preset: &str, params: Params| see(&scene, preset, params).leaks(2, 0.1);
    let fading = [40.0, 80.0, 1000.0]
        .map(|exponent| leaks("esm", &[map(2048), float("exponent", exponent)]));
    println!("esm leaks at {fading:?} pixels");
    assert!(fading[1] > 300, "{fading:?}");
    assert!(
        fading[1] < fading[0] && fading[2] * 10 < fading[1],
        "{fading:?}"
    );
    let compared = leaks("pcf", &[map(2048)]);
    assert_eq!(compared, 0);
}

/// The edges of two shadows are as wide as one another, though one caster is thirty times as far.
#[test]
fn the_blur_of_pcf_knows_no_distance() {
    let scene = case("near_and_far");
    for radius in [2, 6] {
        let seen = see(&scene, "pcf", &[map(512), number("radius", radius)]);
        let between = |pixel: &usize| (0.1..0.9).contains(&seen.visibility[*pixel]);
        let pixels = (0..seen.visibility.len()).filter(between);
        let (near, far): (Vec<usize>, Vec<usize>) =
            pixels.partition(|&pixel| seen.position[pixel].x < 0.0);
        println!(
            "pcf, radius {radius}: {} and {} pixels",
            near.len(),
            far.len()
        );
        assert!(near.len() > 100, "{}", near.len());
        let ratio = far.len() as f64 / near.len() as f64;
        assert!((0.4..2.5).contains(&ratio), "{ratio}");
    }
    // Under a lamp of four degrees the oracle's do differ.
    let sun = scene.sun().unwrap();
    let lamp = DirectionalLight {
        angle_degrees: 4.0,
        ..sun
    };
    let (oracle, camera) = (Oracle::new(&scene.mesh), scene.views[0].camera(VIEWPORT));
    let primitives = oracle.primary(&camera, Progress::default()).unwrap();
    let (how, progress) = ((OracleMode::Exact, 64), Progress::default());
    let truth = ground_truth(&oracle, &camera, lamp, &primitives, how, progress).unwrap();
    let shares = truth.shares();
    let seen = see(&scene, "pcf", &[map(512)]);
    let between = |right: bool| {
        let pixels = shares.iter().zip(&seen.position);
        let found =
            pixels.filter(|(share, at)| (0.1..0.9).contains(*share) && (at.x >= 0.0) == right);
        found.count()
    };
    let (near, far) = (between(false), between(true));
    println!("the oracle: {near} and {far} pixels");
    assert!(far > 4 * near, "{near}, {far}");
}

/// A spot light's cone and the six faces of a point light.
#[test]
fn pcf_is_right_but_for_its_blur_under_lamps() {
    let solid = Scene::clone(&case("near_and_far"));
    let masked = Scene {
        mesh: foliage(6, 1.2, 4.0, 5),
        ..solid.clone()
    };
    // Leaves have no backs that could cast in their stead.
    let whole = ("cull", ParamValue::Choice("none".into()));
    let of_leaves = [map(1024), whole, float("slope_bias", 1.5)];
    for (scene, params, most) in [
        (solid, &of_leaves[..1], 0.0),
        (masked, &of_leaves[..], 0.02),
    ] {
        for lamp in lamps() {
            let scene = Arc::new(Scene {
                lights: vec![lamp.into()],
                ..scene.clone()
            });
            let seen = see(&scene, "pcf", params);
            for (class, light) in [(Class::Lit, 1.0), (Class::Shadow, 0.0)] {
                let pixels = seen.inside(class, 3);
                let wrong = |pixel: &&usize| (seen.visibility[**pixel] - light).abs() > 0.1;
                let wrong = pixels.iter().filter(wrong).count() as f64 / pixels.len() as f64;
                println!("{lamp:?} {class:?}: {wrong} of {} wrong", pixels.len());
                assert!(pixels.len() > 300 && wrong <= most, "{lamp:?} {class:?}");
            }
        }
    }
}

fn lamps() -> [LightKind; 2] {
    let position = DVec3::new(0.6, 5.0, 0.5);
    let spot = SpotLight {
        position,
        direction: DVec3::new(-0.1, -1.0, -0.1),
        cone_degrees: 70.0,
        radius: 0.0,
    };
    let point = PointLight {
        position,
        radius: 0.0,
    };
    [LightKind::Spot(spot), LightKind::Point(point)]
}

/// Comparison sampler and shader, hardware filter and shader: the same picture.
#[test]
fn the_device_filters_as_the_shaders_do() {
    let scene = case("two_occluders");
    let word = |name: &'static str, word: &str| (name, ParamValue::Choice(word.into()));
    let flag = |name: &'static str, flag| (name, ParamValue::Bool(flag));
    for (preset, ways, size) in [
        (
            "pcf",
            [word("compare", "sampler"), word("compare", "by_hand")],
            100,
        ),
        (
            "vsm",
            [flag("filterable", true), flag("filterable", false)],
            100,
        ),
        // Mips are looked up.
        (
            "vsm",
            [flag("filterable", true), flag("filterable", false)],
            1024,
        ),
        (
            "esm",
            [flag("filterable", true), flag("filterable", false)],
            1024,
        ),
    ] {
        let [device, shader] = ways.map(|way| see(&scene, preset, &[map(size), way]).visibility);
        let differences = device.iter().zip(&shader).map(|(a, b)| (a - b).abs());
        let worst = differences.fold(0.0, f32::max);
        println!("{preset} {size}: {worst}");
        // Devices place samples to 1/256 of a texel.
        assert!(worst < 0.02, "{preset} {size}: {worst}");
        let soft = device.iter().filter(|share| (0.1..0.9).contains(*share));
        assert!(soft.count() > 100, "{preset} {size}");
    }
}

/// Holds also for nothing but lit receivers and for maps of one texel.
#[test]
fn a_lit_floor_does_not_shade_itself() {
    let scene = case("near_and_far");
    for preset in ["pcf", "vsm", "esm"] {
        for size in [1, 3, 64, 1000] {
            let seen = see(&scene, preset, &[map(size)]);
            // Far from all shadows.
            let edge = |pixel: &usize| seen.position[*pixel].z < -1.2;
            let lit = seen.inside(Class::Lit, 3);
            let lit: Vec<usize> = lit.into_iter().filter(edge).collect();
            assert!(lit.len() > 100, "{}", lit.len());
            if size > 3 {
                let least = lit.iter().map(|&pixel| seen.visibility[pixel]);
                let least = least.fold(1.0, f32::min);
                assert!(least > 0.9, "{preset} {size}: {least}");
            }
        }
    }
}
