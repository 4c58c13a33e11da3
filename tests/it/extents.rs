//! Resolution of f32: surfaces told from themselves, and one scene however large, far off or
//! coarse.
//!
//! The sweep behind the table of docs/precision.md is a suite of its own, which CI runs:
//! `cargo test -p skiagraph-tests --test extents -- --ignored --nocapture`

use crate::support::{bench::Bench, meshes};
use glam::{DVec3, Vec3};
use skiagraph_reference::Statistics;
use skiagraph_scene::{DirectionalLight, Mesh, Scene, View};
use std::sync::Arc;

fn scene(mesh: Mesh, eye: DVec3, target: DVec3, far: f64, direction: DVec3) -> Arc<Scene> {
    Arc::new(Scene {
        name: "extents".into(),
        mesh,
        views: vec![View {
            eye,
            direction: target - eye,
            fov_y_degrees: 50.0,
            near: 0.01 * (target - eye).length(),
            far,
            ..View::default()
        }],
        lights: vec![DirectionalLight::new(direction).into()],
    })
}

/// A plane sheet, askew, of `cells` by `cells` squares of two triangles, `size` across, its middle
/// at `at`.
fn sheet(cells: u16, size: f32, at: Vec3) -> Mesh {
    let (u, v) = (Vec3::new(0.81, 0.37, -0.29), Vec3::new(0.23, 0.31, 0.93));
    let line = u32::from(cells) + 1;
    let place = |i: u32| f32::from(i as u16) / f32::from(cells) - 0.5;
    let positions =
        (0..line * line).map(|i| at + (u * place(i % line) + v * place(i / line)) * size);
    let triangles = (0..line * (line - 1))
        .filter(|i| i % line + 1 < line)
        .flat_map(|i| [[i, i + line, i + 1], [i + 1, i + line, i + line + 1]]);
    meshes::mesh(positions.collect(), triangles.collect())
}

/// All its triangles face the light, and nothing else is there. The oracle finds some pixels in
/// shadow, of corners that rounding has put an ulp in front of their neighbours'; those aside a
/// receiver that was found below the sheet must not meet it.
#[test]
fn a_sheet_does_not_shade_itself() {
    for (size, at) in [
        (2.0, Vec3::ZERO),
        (2.0, Vec3::new(300.0, 200.0, -500.0)),
        (20.0, Vec3::new(3.0, 2.0, 5.0)),
    ] {
        let middle = at.as_dvec3();
        let eye = middle + DVec3::new(0.4, 0.9, 0.3);
        let light = DVec3::new(0.3, -1.0, -0.2);
        let scene = scene(sheet(64, size, at), eye, middle, 100.0, light);
        let counts = Bench::new(&scene, [512, 512]).judge("rt", &[]);
        assert!(counts.pixels.lit > 200_000, "{size} {at}: {counts:?}");
        assert_eq!(counts.wrong.shadow, 0, "{size} {at}: {counts:?}");
    }
}

/// Two boulders over a square floor of two triangles, `half` to every side; what the camera sees is
/// four units across.
fn boulders(half: f32) -> Mesh {
    let mut positions = vec![
        Vec3::new(-half, 0.0, half),
        Vec3::new(half, 0.0, half),
        Vec3::new(half, 0.0, -half),
        Vec3::new(-half, 0.0, -half),
    ];
    // Askew, as no coordinate of a floor at a height of 0 is ever rounded.
    let tilt = |p: Vec3| p + Vec3::Y * (0.13 * p.x - 0.07 * p.z);
    let mut triangles = vec![[0, 1, 2], [0, 2, 3]];
    for (seed, at, radius) in [
        (1, Vec3::new(-0.3, 0.5, 0.1), 0.4),
        (2, Vec3::new(0.6, 0.3, -0.4), 0.2),
    ] {
        let boulder = meshes::potato(1, 0.2, seed);
        let first = positions.len() as u32;
        positions.extend(boulder.positions.iter().map(|&p| at + p * radius));
        triangles.extend(boulder.triangles.iter().map(|t| t.map(|i| i + first)));
    }
    meshes::mesh(positions.into_iter().map(tilt).collect(), triangles)
}

/// The boulders, as large as that, as far off, on a floor that large; what the oracle says of them,
/// traced.
fn measured(scale: f64, offset: f64, half: f32) -> Statistics {
    let mut mesh = boulders(half);
    for position in &mut mesh.positions {
        *position = (position.as_dvec3() * scale + DVec3::splat(offset)).as_vec3();
    }
    let place = |p: DVec3| p * scale + DVec3::splat(offset);
    let (eye, target) = (
        place(DVec3::new(1.4, 1.9, 2.3)),
        place(DVec3::new(0.1, 0.2, 0.0)),
    );
    let far = 100.0 * (target - eye).length();
    let scene = scene(mesh, eye, target, far, DVec3::new(0.7, -1.0, 0.43));
    Bench::new(&scene, [128, 128]).judge("rt", &[])
}

/// Extents of the scene but for its floor.
const EXTENT: f64 = 4.0;

#[test]
#[ignore = "a suite: `./test.sh --all` runs it"]
fn what_holds_at_any_scale_distance_and_coarseness() {
    let mut failed = Vec::new();
    println!(
        "{:24}{:>8}{:>8}{:>19}{:>15}",
        "", "shadow", "wrong", "wrong determinate", "indeterminate"
    );
    let mut row = |what: String, counts: Statistics, most: Option<f64>| {
        let determinate = counts.wrong.total - counts.wrong.in_band;
        let share = counts.indeterminate_share();
        println!(
            "{what:24}{:>8}{:>8}{determinate:>19}{:>14.2}%",
            counts.pixels.shadow,
            counts.wrong.total,
            100.0 * share
        );
        if most.is_some_and(|most| determinate > 0 || share > most || counts.pixels.shadow == 0) {
            failed.push(what);
        }
    };
    for (exponent, most) in [
        (-24, None),
        (-20, None),
        (-19, Some(0.01)),
        (-16, Some(0.01)),
        (-12, Some(0.01)),
        (0, Some(0.01)),
        (12, Some(0.01)),
        (18, Some(0.01)),
        (20, None),
    ] {
        let counts = measured(10f64.powi(exponent), 0.0, 2.0);
        row(format!("scale 1e{exponent}"), counts, most);
    }
    for (exponent, most) in [
        (2, Some(0.01)),
        (3, Some(0.02)),
        (4, None),
        (5, None),
        (6, None),
    ] {
        let counts = measured(1.0, EXTENT * 10f64.powi(exponent), 2.0);
        row(format!("extents off 1e{exponent}"), counts, most);
    }
    for (exponent, most) in [
        (2, Some(0.01)),
        (3, Some(0.01)),
        (4, Some(0.01)),
        (5, None),
        (6, None),
    ] {
        let counts = measured(1.0, 0.0, 0.5 * 10f32.powi(exponent));
        row(format!("floor to a unit 1e{exponent}"), counts, most);
    }
    assert!(
        failed.is_empty(),
        "not as docs/precision.md says: {failed:?}"
    );
}
