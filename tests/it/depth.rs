//! The depth of the G-buffer tells surfaces apart however near the near plane is, and places come
//! back from it.

use crate::support::graphs::{open, plan, plan_files, provider, run_on, shares, values};
use glam::DVec3;
use skiagraph_reference::{BACKGROUND, Oracle, Progress, wrong_surfaces};
use skiagraph_scene::{DirectionalLight, Indexed, Mesh, Scene, View};
use std::sync::Arc;

const VIEWPORT: [u32; 2] = [64, 64];

/// A floor of 8 × 8, and a plate of 2 × 2 one unit above it.
fn plate_over_floor() -> Mesh {
    let square = |half: f32, y: f32| {
        [(-half, -half), (-half, half), (half, half), (half, -half)].map(|(x, z)| [x, y, z])
    };
    Indexed {
        positions: &[square(4.0, 0.0), square(1.0, 1.0)].concat(),
        normals: &[],
        // The floor is drawn first: of equal depths the first one stays.
        indices: &[0, 1, 2, 0, 2, 3, 4, 5, 6, 4, 6, 7],
    }
    .mesh()
    .unwrap()
}

/// The whole floor from 3,000 above.
fn far_above(near: f64) -> Arc<Scene> {
    let eye = DVec3::new(300.0, 3000.0, 10.0);
    Arc::new(Scene {
        name: "plate".into(),
        mesh: plate_over_floor(),
        views: vec![View {
            name: "far".into(),
            eye,
            direction: -eye,
            fov_y_degrees: 0.2,
            near,
            far: 10_000.0,
            ..View::default()
        }],
        lights: vec![DirectionalLight::new(DVec3::new(0.3, -1.0, 0.2)).into()],
    })
}

#[test]
fn a_near_plane_however_near_hides_no_plate_behind_its_floor() {
    let gpu = open();
    let shown = [100.0, 0.1, 1e-4, 1e-10].map(|near| {
        let scene = far_above(near);
        let view = &scene.views[0];
        let mut provider = provider(&scene, view, VIEWPORT);
        let plan = plan("pipelines/shared/gbuffer.ron", &provider, VIEWPORT, |_| {});
        let shown = values(
            &run_on(&gpu, plan, &mut provider, &["primitive"]),
            "primitive",
        );
        let wrong = wrong_surfaces(
            &Oracle::new(&scene.mesh),
            &view.camera(VIEWPORT),
            &shown,
            Progress::default(),
        );
        assert_eq!(wrong.unwrap(), 0, "near {near}");
        let of_plate = shown.iter().filter(|id| (2..4).contains(*id)).count();
        assert!(of_plate > 100, "near {near}: {of_plate}");
        shown
    });
    for other in &shown[1..] {
        assert!(*other == shown[0]);
    }
}

/// `unprojection` is of the depth that the G-buffer draws.
#[test]
fn a_receiver_comes_back_from_the_gbuffers_depth() {
    let gpu = open();
    let document = r#"(
        format: 3,
        materials: [Texture(name: "place", format: Rgba32Float)],
        passes: [
            Include(graph: "shared/gbuffer.ron"),
            Fullscreen(name: "back", color: ["place"]),
        ],
        outputs: ["place", "primitive", "position"],
    )"#;
    let shader = r#"
        #import "shared/unprojection.wgsl"
        var depth: texture_depth_2d;
        @fragment fn fragment(@builtin(position) centre: vec4<f32>) -> @location(0) vec4<f32> {
            let pixel = vec2<u32>(centre.xy);
            let seen = textureLoad(depth, pixel, 0);
            if seen == farthest_depth() {
                return vec4(0.0);
            }
            let relative = relative_at_depth(pixel, textureDimensions(depth), seen);
            return vec4(relative + unprojection.origin_low + unprojection.origin, 1.0);
        }
    "#;
    for near in [100.0, 1e-4] {
        let scene = far_above(near);
        let mut provider = provider(&scene, &scene.views[0], VIEWPORT);
        let files = [("test.ron", document), ("back.wgsl", shader)];
        let plan = plan_files(&files, &provider, VIEWPORT);
        let outputs = ["place", "primitive", "position"];
        let report = run_on(&gpu, plan, &mut provider, &outputs);
        let [places, positions] = ["place", "position"].map(|name| shares(&report, name));
        let mut seen = 0;
        for (pixel, primitive) in values(&report, "primitive").into_iter().enumerate() {
            let texel = |texels: &[f32]| {
                let texel = &texels[4 * pixel..4 * pixel + 4];
                (
                    DVec3::new(texel[0].into(), texel[1].into(), texel[2].into()),
                    texel[3],
                )
            };
            let ((place, is_there), (position, _)) = (texel(&places), texel(&positions));
            assert_eq!(primitive != BACKGROUND, is_there == 1.0);
            if primitive != BACKGROUND {
                seen += 1;
                // An ulp of 3,000 is 0.00024.
                let off = place.distance(position);
                assert!(off < 0.005, "near {near}: {place} instead of {position}");
            }
        }
        assert!(seen > 1000, "{seen}");
    }
}
