//! The views that results are published for: Sponza's `main`, the nine of `bench` and of `park`.
//!
//! The meshes of Sponza and of `bench` are not part of the repository: their tests need the folder
//! with `sponza/sponza.obj` and `bench/bench.obj` in the environment variable `SKIAGRAPH_ASSETS`,
//! relative to the workspace or absolute.

use crate::common::f32_shading;
use skiagraph_reference::{GroundTruthPixels, Oracle, OracleMode, Progress, Statistics};
use skiagraph_scene::{Bvh, Camera, Scene, SceneLibrary, View};
use std::{path::Path, sync::OnceLock, time::Instant};

/// Most indeterminate pixels, as a share of those facing the light.
const INDETERMINATE_CAP: f64 = 1e-3;

/// A scene whose mesh is not part of the repository, or `None`, with a word why, where no folder is
/// named. A folder without the mesh is a failure.
fn downloaded(name: &str) -> Option<Scene> {
    let Some(folders) = std::env::var_os("SKIAGRAPH_ASSETS") else {
        println!("SKIAGRAPH_ASSETS is not set: nothing to test without the mesh of {name}");
        return None;
    };
    // Tests run in the crate's folder, but a relative path is meant from where the command is
    // typed.
    let workspace = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let assets = std::env::split_paths(&folders)
        .map(|folder| workspace.join(folder))
        .collect();
    Some(scene(
        name,
        SceneLibrary {
            assets,
            ..SceneLibrary::default()
        },
    ))
}

fn sponza() -> Option<&'static Scene> {
    static SPONZA: OnceLock<Option<Scene>> = OnceLock::new();
    SPONZA.get_or_init(|| downloaded("sponza")).as_ref()
}

fn scene(name: &str, library: SceneLibrary) -> Scene {
    let (scene, _) = library.load(name).unwrap_or_else(|error| panic!("{error}"));
    scene
}

fn main_view(scene: &Scene) -> &View {
    scene.view("main").expect("the scene file names it")
}

/// The ids that a rasteriser with 8 bits of subpixel precision might write: vertices snapped half a
/// step off.
fn snapped(camera: &Camera) -> Camera {
    let step = |half: f64, pixels: u32| 2.0 * half / f64::from(pixels) / 512.0;
    let shift = camera.right * step(camera.half_width, camera.viewport[0])
        + camera.up * step(camera.half_height, camera.viewport[1]);
    Camera {
        forward: camera.forward + shift,
        ..*camera
    }
}

fn shade(
    oracle: &Oracle,
    scene: &Scene,
    camera: &Camera,
    primitives: &[u32],
    mode: OracleMode,
) -> GroundTruthPixels {
    oracle
        .shade(camera, scene.light(), primitives, mode, Progress::default())
        .expect("the mesh's own primitives")
}

/// Shading in f32 against the oracle, on a rasteriser's ids: wrong in indeterminate
/// pixels only, and these are few.
fn f32_errs_in_few_indeterminate_pixels_only(scene: &Scene, mode: OracleMode) {
    let bvh = Bvh::build(&scene.mesh);
    let oracle = Oracle::new(&scene.mesh);
    for view in &scene.views {
        let camera = view.camera([480, 360]);
        let primitives = oracle
            .primary(&snapped(&camera), Progress::default())
            .expect("it is not stopped");
        let truth = shade(&oracle, scene, &camera, &primitives, mode);
        let (visibility, status) = f32_shading::shade(
            &scene.mesh,
            &bvh,
            &camera,
            scene.sun().unwrap(),
            &primitives,
            mode,
        );
        let counts = Statistics::judged(&visibility, &status, &truth).expect("valid values");
        let (name, share) = (&view.name, 100.0 * counts.indeterminate_share());
        println!("{name} {mode}: {counts:?}, indeterminate {share:.4} %");
        assert_eq!(counts.wrong.total, counts.wrong.in_band, "{name}");
        assert!(
            counts.indeterminate_share() < INDETERMINATE_CAP,
            "{name}: {counts:?}"
        );
    }
}

#[test]
#[ignore = "a suite: `./test.sh --all` runs it"]
fn sponza_has_the_dissertations_counts() {
    let Some(scene) = sponza() else { return };
    assert_eq!(scene.mesh.triangles.len(), 262_267);
    let oracle = Oracle::new(&scene.mesh);
    // Dissertation, table 6: PFL, lit, shadow.
    for (viewport, expected) in [
        ([512, 512], [207_377, 117_780, 89_597]),
        ([1024, 1024], [829_652, 471_083, 358_569]),
        ([1920, 1080], [1_655_090, 955_576, 699_514]),
    ] {
        let camera = main_view(scene).camera(viewport);
        let begin = Instant::now();
        let primitives = oracle
            .primary(&camera, Progress::default())
            .expect("it is not stopped");
        println!("{viewport:?} primary rays: {:?}", begin.elapsed());
        for mode in [OracleMode::Offset(0.03), OracleMode::Exact] {
            let begin = Instant::now();
            let truth = shade(&oracle, scene, &camera, &primitives, mode);
            let elapsed = begin.elapsed();
            let counts =
                Statistics::judged(&truth.visibility(), &truth.status(), &truth).expect("its own");
            let (pixels, share) = (counts.pixels, 100.0 * counts.indeterminate_share());
            println!(
                "{viewport:?} {mode}: {pixels:?}, indeterminate {} ({share:.4} %), {elapsed:?}",
                counts.band
            );
            assert_eq!(pixels.background, 0);
            assert_eq!(counts.wrong.total, 0);
            assert!(
                counts.indeterminate_share() < INDETERMINATE_CAP,
                "{counts:?}"
            );
            if mode != OracleMode::Exact {
                for (count, expected) in [pixels.facing_light, pixels.lit, pixels.shadow]
                    .into_iter()
                    .zip(expected)
                {
                    let off = count.abs_diff(expected) as f64 / expected as f64;
                    assert!(off < 1e-3, "{viewport:?}: {count} instead of {expected}");
                }
            }
        }
    }
}

#[test]
#[ignore = "a suite: `./test.sh --all` runs it"]
fn bench_in_f32() {
    let Some(scene) = downloaded("bench") else {
        return;
    };
    assert_eq!(scene.views.len(), 9);
    f32_errs_in_few_indeterminate_pixels_only(&scene, OracleMode::Exact);
}

#[test]
#[ignore = "a suite: `./test.sh --all` runs it"]
fn sponza_in_f32() {
    let Some(scene) = sponza() else { return };
    for mode in [OracleMode::Exact, OracleMode::Offset(0.03)] {
        f32_errs_in_few_indeterminate_pixels_only(scene, mode);
    }
}

#[test]
#[ignore = "a suite: `./test.sh --all` runs it"]
fn park_in_f32() {
    let scene = scene("park", SceneLibrary::default());
    assert_eq!(scene.views.len(), 9);
    f32_errs_in_few_indeterminate_pixels_only(&scene, OracleMode::Exact);
}
