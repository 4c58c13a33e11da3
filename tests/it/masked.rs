//! Masked and double-sided triangles: every method and engine against the oracle.

use crate::plant;
use crate::support::{bench::Bench, meshes::foliage};
use glam::DVec3;
use skiagraph_graph::ParamValue;
use skiagraph_reference::{BACKGROUND, Oracle, Progress};
use skiagraph_scene::{
    DirectionalLight, LightKind, PointLight, Scene, SceneLibrary, SpotLight, View,
};
use std::sync::Arc;

const VIEWPORT: [u32; 2] = [160, 120];

fn scene(seed: u64) -> Arc<Scene> {
    scene_under(
        seed,
        DirectionalLight::new(DVec3::new(-0.4, -1.0, 0.3)).into(),
    )
}

fn scene_under(seed: u64, light: LightKind) -> Arc<Scene> {
    let eye = DVec3::new(0.7, 2.0, 4.0);
    Arc::new(Scene {
        name: "foliage".into(),
        mesh: foliage(60, 0.35, 4.0, seed),
        views: vec![View {
            eye,
            direction: DVec3::new(0.0, -0.5, 0.0) - eye,
            fov_y_degrees: 50.0,
            far: 50.0,
            ..View::default()
        }],
        lights: vec![light.into()],
    })
}

fn word(text: &str) -> ParamValue {
    ParamValue::Choice(text.into())
}

#[test]
fn exact_methods_are_right_on_masked_triangles() {
    for seed in [1, 2, 3] {
        let scene = scene(seed);
        let mut bench = Bench::new(&scene, VIEWPORT);
        bench.look(&scene.views[0]);
        for (preset, params) in [
            ("rt", vec![]),
            ("rt", vec![("engine", word("light_space"))]),
            ("light_buffer", vec![]),
            (
                "light_buffer",
                vec![("map_size", ParamValue::U32(64)), ("fit", word("scene"))],
            ),
        ] {
            let counts = bench.judge(preset, &params);
            let (pixels, wrong) = (counts.pixels, counts.wrong);
            println!(
                "{preset} {params:?} seed {seed}: {pixels:?} {wrong:?} band {}",
                counts.band
            );
            assert_eq!(wrong.total, wrong.in_band, "{preset} {params:?}");
            assert!(pixels.lit > 1000 && pixels.shadow > 1000, "{pixels:?}");
            // Few pixels hang on the rounding of a mask.
            assert!(100 * counts.band < pixels.facing_light, "{}", counts.band);
        }
    }
}

#[test]
fn what_conservative_maps_are_certain_of_is_right() {
    let none = ("cull", word("none"));
    for seed in [1, 2] {
        let scene = scene(seed);
        let mut bench = Bench::new(&scene, VIEWPORT);
        bench.look(&scene.views[0]);
        for preset in ["crsm", "crsma", "crsma_full", "crsm_depth", "crsm_single"] {
            let counts = bench.judge(preset, std::slice::from_ref(&none));
            println!("{preset} seed {seed}: {counts:?}");
            assert_eq!(counts.wrong.certain, 0, "{preset}: {counts:?}");
        }
    }
}

/// Maps of every kind of light and fit let the light through the holes: what is wrong of them is
/// what is between texels.
#[test]
fn maps_have_holes_where_casters_have() {
    let position = DVec3::new(0.8, 5.0, -0.6);
    let spot = LightKind::Spot(SpotLight {
        position,
        direction: -position,
        cone_degrees: 80.0,
        radius: 0.0,
    });
    let point = LightKind::Point(PointLight {
        position,
        radius: 0.0,
    });
    let sun: LightKind = DirectionalLight::new(DVec3::new(-0.4, -1.0, 0.3)).into();
    for (preset, light, fit) in [
        ("nsm", spot, "scene"),
        ("hybrid_pcf", spot, "scene"),
        ("nsm", point, "scene"),
        ("nsm", sun, "scene"),
        ("nsm", sun, "pssm"),
        ("pssm", sun, "pssm"),
        ("sdsm", sun, "pssm"),
        ("nsm", sun, "tsm"),
    ] {
        let scene = scene_under(2, light);
        let mut bench = Bench::new(&scene, VIEWPORT);
        let params = [
            ("map_size", ParamValue::U32(2048)),
            ("cull", word("none")),
            ("fit", word(fit)),
            ("slope_bias", ParamValue::F32(1.0)),
        ];
        let asked = if preset == "hybrid_pcf" { 3 } else { 4 };
        let counts = bench.judge(preset, &params[..asked]);
        let wrong = counts.wrong.total - counts.wrong.in_band;
        println!(
            "{preset} {light:?} {fit}: {wrong} wrong of {:?}",
            counts.pixels
        );
        assert!(counts.pixels.shadow > 1000, "{:?}", counts.pixels);
    }
}

#[test]
fn the_gbuffer_shows_what_the_oracle_sees() {
    let scene = scene(4);
    let mut bench = Bench::new(&scene, VIEWPORT);
    let answers = bench.answers("rt", &[]);
    let oracle = Oracle::new(&scene.mesh);
    let camera = scene.views[0].camera(VIEWPORT);
    let seen = oracle.primary(&camera, Progress::default()).unwrap();
    let differ = seen.iter().zip(&answers.primitives).filter(|(a, b)| a != b);
    // Outlines, where a rasteriser snaps corners or rounds a texel the other way.
    assert!(differ.count() * 100 < seen.len());
    let from_behind = |&primitive: &u32| {
        primitive != BACKGROUND && {
            let [a, b, c] = scene.mesh.corners(primitive);
            (b - a).cross(c - a).dot(a - camera.eye) > 0.0
        }
    };
    assert!(seen.iter().filter(|it| from_behind(it)).count() > 500);
}

#[test]
fn a_generated_plant_of_gltf_is_right() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("foliage.glb"), plant::plant()).unwrap();
    let text = include_str!("../../scenes/foliage.ron");
    let file = folder.path().join("foliage.ron");
    std::fs::write(&file, text).unwrap();
    let (scene, _) = SceneLibrary::default()
        .load(&file.display().to_string())
        .unwrap();
    let scene = Arc::new(scene);
    let mut bench = Bench::new(&scene, VIEWPORT);
    for view in &scene.views {
        bench.look(view);
        for preset in ["rt", "light_buffer"] {
            let counts = bench.judge(preset, &[]);
            assert_eq!(counts.wrong.total, counts.wrong.in_band, "{preset}");
            assert!(counts.pixels.shadow > 1000, "{:?}", counts.pixels);
        }
    }
}
