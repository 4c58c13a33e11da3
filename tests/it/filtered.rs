//! Filtered shadow maps: `pcf`, `pcss`, `vsm`, `evsm`, `msm`, `esm`. Each shows its known artefact
//! on the case made for it, and less of it by the param that is meant against it.

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
    shares: Vec<f32>,
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
        request.captures = captured.map(Capture::new).into();
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
    let (oracle, camera) = (Oracle::new(&scene.mesh), scene.views[0].camera(VIEWPORT));
    let primitives = values(&report, "primitive");
    let (how, progress) = ((OracleMode::Exact, 64), Progress::default());
    let truth = ground_truth(&oracle, &camera, scene.light(), &primitives, how, progress).unwrap();
    Seen {
        visibility,
        shares: truth.shares().into_owned(),
        position: shares(&report, "position")
            .chunks_exact(4)
            .map(Vec3::from_slice)
            .collect(),
        classes: truth.pixels.classes,
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

    /// Returns what is shown of the light and what is true, of each pixel that faces it.
    fn facing(&self) -> impl Iterator<Item = (f32, f32)> {
        let answers = self.visibility.iter().zip(&self.shares).zip(&self.classes);
        let faces = |(_, class): &(_, &Class)| matches!(class, Class::Lit | Class::Shadow);
        answers
            .filter(faces)
            .map(|((shown, share), _)| (*shown, *share))
    }

    /// Counts the pixels that see none of the light and get more than this share of it.
    fn lit_umbra(&self, more_than: f32) -> usize {
        let lit = |&(shown, share): &(f32, f32)| share == 0.0 && shown > more_than;
        self.facing().filter(lit).count()
    }

    fn rmse(&self) -> f32 {
        let squares: f32 = self.facing().map(|(a, b)| (a - b) * (a - b)).sum();
        (squares / self.facing().count() as f32).sqrt()
    }
}

fn under(scene: &Scene, light: impl Into<LightKind>) -> Arc<Scene> {
    Arc::new(Scene {
        lights: vec![light.into().into()],
        ..scene.clone()
    })
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
    let whole = float("bleed_reduction", 0.0);
    let fading = [40.0, 80.0, 1000.0].map(|exponent| {
        let params = [map(2048), float("exponent", exponent), whole.clone()];
        leaks("esm", &params)
    });
    println!("esm leaks at {fading:?} pixels");
    assert!(fading[1] > 300, "{fading:?}");
    assert!(
        fading[1] < fading[0] && fading[2] * 10 < fading[1],
        "{fading:?}"
    );
    let compared = leaks("pcf", &[map(2048)]);
    assert_eq!(compared, 0);
}

/// The dissertation's threshold (3.3.2): light that is no more than a share counts as none.
#[test]
fn esm_fails_less_at_contact_under_a_threshold() {
    let scene = case("contact");
    let leaks = [0.0, 0.2, 0.5].map(|cut| {
        let params = [map(2048), float("bleed_reduction", cut)];
        see(&scene, "esm", &params).leaks(2, 0.1)
    });
    println!("esm leaks at {leaks:?} pixels");
    assert!(leaks[0] > leaks[1] && leaks[0] > 2 * leaks[2], "{leaks:?}");
}

/// On the case made for the artefact of either, and its own: under small exponents it is `vsm`.
#[test]
fn evsm_leaks_less_than_vsm_and_esm() {
    let whole = float("bleed_reduction", 0.0);
    let two = case("two_occluders");
    let leaks = |preset: &str, params: Params| see(&two, preset, params).leaks(4, 0.1);
    let wide = [map(512), number("radius", 4), whole.clone()];
    let vsm = leaks("vsm", &wide);
    let evsm = [2.0, 10.0, 40.0].map(|exponent| {
        let params = [&wide[..], &[float("exponent", exponent)]].concat();
        leaks("evsm", &params)
    });
    println!("vsm leaks at {vsm} pixels, evsm at {evsm:?}");
    assert!(evsm[0] > 50 && evsm[0] > evsm[1], "{evsm:?}");
    assert!(10 * evsm[2] < vsm, "{vsm}, {evsm:?}");
    let contact = case("contact");
    let [esm, evsm] = ["esm", "evsm"]
        .map(|preset| see(&contact, preset, &[map(2048), whole.clone()]).leaks(2, 0.1));
    println!("at contact esm leaks at {esm} pixels, evsm at {evsm}");
    assert!(2 * evsm < esm, "{esm}, {evsm}");
}

/// With half as many bits. Three depths under one filter are more than four moments can tell.
#[test]
fn msm_leaks_less_than_vsm_but_behind_three_occluders() {
    let whole = float("bleed_reduction", 0.0);
    let leaks = |name: &str, preset: &str, params: Params| {
        let params = [params, std::slice::from_ref(&whole)].concat();
        see(&case(name), preset, &params).leaks(4, 0.1)
    };
    let fine = [map(512), number("radius", 4)];
    // 16 bytes a texel for 8.
    let coarse = [map(256), number("radius", 2)];
    let two = [("vsm", fine), ("msm", coarse)]
        .map(|(preset, params)| leaks("two_occluders", preset, &params));
    println!(
        "behind two vsm leaks at {} pixels, msm at {}",
        two[0], two[1]
    );
    assert!(two[0] > 50 && 4 * two[1] < two[0], "{two:?}");
    let fine = [map(512), number("radius", 4)];
    let [two, three] = ["two_occluders", "three_occluders"].map(|name| leaks(name, "msm", &fine));
    println!("msm leaks at {two} pixels behind two, at {three} behind three");
    assert!(three > 15 && three > 4 * two, "{two}, {three}");
}

/// Pixels in the penumbra of the plate near the floor, and of that far above it.
fn penumbrae(shares: &[f32], position: &[Vec3]) -> [usize; 2] {
    let pixels = shares.iter().zip(position);
    let between = pixels.filter(|(share, _)| (0.1..0.9).contains(*share));
    let (near, far): (Vec<_>, Vec<_>) = between.partition(|(_, at)| at.x < 0.0);
    [near.len(), far.len()]
}

/// `near_and_far` under a sun four degrees wide.
fn wide_sun(direction: Option<DVec3>) -> Arc<Scene> {
    let scene = case("near_and_far");
    let sun = scene.sun().unwrap();
    let light = DirectionalLight {
        angle_degrees: 4.0,
        ..direction.map_or(sun, DirectionalLight::new)
    };
    under(&scene, light)
}

/// One caster is thirty times as far as the other; the edges of `pcf` are as wide.
#[test]
fn pcss_hardens_at_contact_and_pcf_does_not() {
    let scene = wide_sun(None);
    let pcss = see(&scene, "pcss", &[map(512)]);
    let [near, far] = penumbrae(&pcss.shares, &pcss.position);
    println!("the oracle: {near} and {far} pixels");
    assert!(far > 4 * near, "{near}, {far}");
    let [near, far] = penumbrae(&pcss.visibility, &pcss.position);
    println!("pcss: {near} and {far} pixels, RMSE {}", pcss.rmse());
    assert!(far > 4 * near, "{near}, {far}");
    for radius in [2, 6] {
        let pcf = see(&scene, "pcf", &[map(512), number("radius", radius)]);
        let [near, far] = penumbrae(&pcf.visibility, &pcf.position);
        println!(
            "pcf, radius {radius}: {near} and {far} pixels, RMSE {}",
            pcf.rmse()
        );
        assert!(near > 100, "{near}");
        let ratio = far as f64 / near as f64;
        assert!((0.4..2.5).contains(&ratio), "{ratio}");
        assert!(
            2.0 * pcss.rmse() < pcf.rmse(),
            "{}, {}",
            pcss.rmse(),
            pcf.rmse()
        );
    }
}

/// The map has the plate that is nearer to the light alone: where it hides the other, the shadow of
/// that is as soft as its own.
#[test]
fn pcss_knows_no_blocker_behind_the_nearest() {
    let hidden = wide_sun(Some(DVec3::new(-0.25, -1.0, 0.1)));
    let [apart, hidden] =
        [wide_sun(None), hidden].map(|scene| see(&scene, "pcss", &[map(512)]).lit_umbra(0.2));
    println!("pcss lights the umbra at {apart} and {hidden} pixels");
    assert!(hidden > 50 && hidden > 10 * apart, "{apart}, {hidden}");
}

#[test]
fn the_noise_of_pcss_falls_with_its_taps() {
    let scene = wide_sun(None);
    let off = [4, 16, 64].map(|taps| {
        let params = [map(512), number("taps", taps), number("blockers", taps)];
        let seen = see(&scene, "pcss", &params);
        seen.facing().filter(|(a, b)| (a - b).abs() > 0.125).count()
    });
    println!("pcss is off by more than 1/8 at {off:?} pixels");
    assert!(off[0] > 2 * off[1] && off[1] > off[2], "{off:?}");
}

#[test]
fn pcss_widens_under_lamps_with_an_extent() {
    let scene = case("near_and_far");
    for mut lamp in lamps() {
        *lamp.parameters().radius.unwrap() = 0.2;
        let scene = under(&scene, lamp);
        let [pcf, pcss] = ["pcf", "pcss"].map(|preset| see(&scene, preset, &[map(512)]).rmse());
        println!("{lamp:?}: pcf {pcf}, pcss {pcss}");
        assert!(3.0 * pcss < 2.0 * pcf, "{lamp:?}: {pcf}, {pcss}");
    }
}

/// A spot light's cone and the six faces of a point light.
#[test]
fn pcf_and_pcss_are_right_but_for_their_blur_under_lamps() {
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
            let scene = under(&scene, lamp);
            for preset in ["pcf", "pcss"] {
                let seen = see(&scene, preset, params);
                for (class, light) in [(Class::Lit, 1.0), (Class::Shadow, 0.0)] {
                    let pixels = seen.inside(class, 3);
                    let wrong = |pixel: &&usize| (seen.visibility[**pixel] - light).abs() > 0.1;
                    let wrong = pixels.iter().filter(wrong).count() as f64 / pixels.len() as f64;
                    println!(
                        "{preset} {lamp:?} {class:?}: {wrong} of {} wrong",
                        pixels.len()
                    );
                    assert!(
                        pixels.len() > 300 && wrong <= most,
                        "{preset} {lamp:?} {class:?}"
                    );
                }
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
        (
            "evsm",
            [flag("filterable", true), flag("filterable", false)],
            1024,
        ),
        (
            "msm",
            [flag("filterable", true), flag("filterable", false)],
            1024,
        ),
    ] {
        // Four moments magnify how devices round.
        let bias = (preset == "msm").then(|| float("moment_bias", 1e-5));
        let params = |way| [map(size), way].into_iter().chain(bias.clone());
        let [device, shader] =
            ways.map(|way| see(&scene, preset, &params(way).collect::<Vec<_>>()).visibility);
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
    for preset in ["pcf", "pcss", "vsm", "evsm", "msm", "esm"] {
        for size in [1, 3, 64, 1000] {
            // Four moments see the plane's own depths before a receiver.
            let bias = (preset == "msm").then(|| float("slope_bias", 1.0));
            let params: Vec<_> = [map(size)].into_iter().chain(bias).collect();
            let seen = see(&scene, preset, &params);
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
