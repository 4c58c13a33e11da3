//! The real Sponza, view `main`. Needs the folder with `sponza/sponza.obj` in the environment variable `SKIAGRAPH_ASSETS`.

mod common;

use common::{sponza, twin};
use skiagraph_reference::{Oracle, OracleMode, Progress, Statistics};
use skiagraph_scene::{Bvh, Camera, Mesh};
use std::{path::PathBuf, sync::OnceLock, time::Instant};

/// The mesh, or `None`, with a word why, where no folder is named. A folder without the mesh is a failure.
fn mesh() -> Option<&'static Mesh> {
    static MESH: OnceLock<Option<Mesh>> = OnceLock::new();
    MESH.get_or_init(load).as_ref()
}

fn load() -> Option<Mesh> {
    let Some(folders) = std::env::var_os("SKIAGRAPH_ASSETS") else {
        println!("SKIAGRAPH_ASSETS is not set: nothing to test without the Sponza mesh");
        return None;
    };
    // Relative folders are meant from the workspace, where the command is typed, not from this crate.
    let workspace = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../..");
    let candidates: Vec<PathBuf> = std::env::split_paths(&folders)
        .map(|folder| workspace.join(folder).join("sponza/sponza.obj"))
        .collect();
    let path = candidates
        .iter()
        .find(|path| path.exists())
        .unwrap_or_else(|| panic!("no mesh at any of {candidates:?}"));
    Some(sponza::load(path))
}

/// |count − expected| as a share of `expected`.
fn off(count: u64, expected: u64) -> f64 {
    count.abs_diff(expected) as f64 / expected as f64
}

/// The ids that a rasteriser with 8 bits of subpixel precision might write: vertices snapped half a step off.
fn snapped(camera: &Camera) -> Camera {
    let step = |half: f64, pixels: u32| 2.0 * half / f64::from(pixels) / 512.0;
    let shift = camera.right * step(camera.half_width, camera.viewport[0])
        + camera.up * step(camera.half_height, camera.viewport[1]);
    Camera {
        forward: camera.forward + shift,
        ..*camera
    }
}

#[test]
fn the_dissertations_counts() {
    let Some(mesh) = mesh() else { return };
    assert_eq!(mesh.triangles.len(), 262_267);
    let oracle = Oracle::new(mesh);
    // Dissertation, table 6: PFL, lit, shadow.
    for (viewport, expected) in [
        ([512, 512], [207_377, 117_780, 89_597]),
        ([1024, 1024], [829_652, 471_083, 358_569]),
        ([1920, 1080], [1_655_090, 955_576, 699_514]),
    ] {
        let camera = sponza::view().camera(viewport);
        let begin = Instant::now();
        let primitives = oracle
            .primary(&camera, Progress::default())
            .expect("nobody interrupts");
        let primary_time = begin.elapsed();
        for mode in [OracleMode::Offset(0.03), OracleMode::Exact] {
            let begin = Instant::now();
            let reference = oracle
                .shade(
                    &camera,
                    &sponza::light(),
                    &primitives,
                    mode,
                    Progress::default(),
                )
                .expect("valid ids");
            let shade_time = begin.elapsed();
            let counts =
                Statistics::judged(&reference.visibility(), &reference.status(), &reference)
                    .expect("its own");
            let pixels = counts.pixels;
            println!(
                "{viewport:?} {mode}: {pixels:?}, band {} ({:.4} %), primary {primary_time:?}, shade {shade_time:?}",
                counts.band,
                100.0 * counts.band_share()
            );
            assert_eq!(pixels.background, 0);
            assert!(counts.band_share() < 1e-3, "{counts:?}");
            assert_eq!(counts.wrong.total, 0);
            if mode != OracleMode::Exact {
                for (count, expected) in [pixels.facing_light, pixels.lit, pixels.shadow]
                    .into_iter()
                    .zip(expected)
                {
                    assert!(
                        off(count, expected) < 1e-3,
                        "{viewport:?}: {count} instead of {expected}"
                    );
                }
            }
        }
    }
}

#[test]
fn f32_errs_in_band_only() {
    let Some(mesh) = mesh() else { return };
    let bvh = Bvh::build(mesh);
    let oracle = Oracle::with_bvh(mesh, &bvh).expect("built over it");
    let camera = sponza::view().camera([640, 480]);
    for shown_by in [camera, snapped(&camera)] {
        let primitives = oracle
            .primary(&shown_by, Progress::default())
            .expect("nobody interrupts");
        for mode in [OracleMode::Offset(0.03), OracleMode::Exact] {
            let reference = oracle
                .shade(
                    &camera,
                    &sponza::light(),
                    &primitives,
                    mode,
                    Progress::default(),
                )
                .expect("valid ids");
            let (visibility, status) =
                twin::shade(mesh, &bvh, &camera, &sponza::light(), &primitives, mode);
            let counts =
                Statistics::judged(&visibility, &status, &reference).expect("valid values");
            println!(
                "{mode}: {:?}, band {} ({:.4} %)",
                counts.wrong,
                counts.band,
                100.0 * counts.band_share()
            );
            assert_eq!(counts.wrong.total, counts.wrong.in_band);
            assert_eq!(counts.wrong.certain, 0);
            assert!(counts.band_share() < 1e-3, "{counts:?}");
        }
    }
}
