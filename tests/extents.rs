//! What f32 can still tell apart: surfaces from themselves, and one scene however large, far off or coarse.
//!
//! The sweep behind the table of docs/precision.md is a suite of its own, which CI runs:
//! `cargo test -p skiagraph-tests --test extents -- --ignored --nocapture`

mod support;

use glam::{DVec3, Vec3};
use skiagraph_scene::{DirectionalLight, Mesh, Scene, View};
use std::sync::Arc;
use support::{bench::Bench, meshes};

fn scene(mesh: Mesh, eye: DVec3, target: DVec3, far: f64, direction: DVec3) -> Arc<Scene> {
    Arc::new(Scene {
        name: "extents".into(),
        mesh,
        views: vec![View {
            name: "main".into(),
            eye,
            direction: target - eye,
            up: DVec3::Y,
            fov_y_degrees: 50.0,
            near: 0.01 * (target - eye).length(),
            far,
        }],
        light: DirectionalLight { direction },
    })
}

/// A plane sheet, askew, of `cells` by `cells` squares of two triangles, `size` across, its middle at `at`.
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

/// All its triangles face the light, and nothing else is there. The oracle finds some pixels in shadow, of corners that rounding has put an ulp in
/// front of their neighbours'; those aside a receiver that was found below the sheet must not meet it.
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
