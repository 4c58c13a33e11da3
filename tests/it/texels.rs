//! The density of shadow maps, held against how far neighbouring pixels lie apart in the map.

use crate::support::graphs::{layered, plan_with, provider, run, shares, values};
use glam::{DVec2, DVec3, Vec3};
use skiagraph_graph::ParamValue;
use skiagraph_reference::{Class, GroundTruthPixels, Oracle, Progress, shimmer::Seen, texels};
use skiagraph_scene::{
    DirectionalLight, Light, LightKind, Mesh, PointLight, Scene, SpotLight, View,
};
use std::sync::Arc;

const VIEWPORT: [u32; 2] = [160, 128];

/// `nsm` that also shows at which texel each pixel looks.
const DOCUMENT: &str = r#"(
    format: 3,
    extends: "pipelines/nsm.ron",
    description: "nsm and its texels",
    materials: [Texture(name: "texel", format: Rgba32Float)],
    passes: [Fullscreen(after: "shadow_lookup", name: "texel", color: ["texel"])],
    outputs: ["texel", "texel_density", "map_layer"],
    lights: [directional, spot, point],
)"#;
const SHADER: &str = r#"
#import "shared/map_layers.wgsl"
#import "shared/receiver.wgsl"

@fragment
fn fragment(@builtin(position) centre: vec4<f32>) -> @location(0) vec4<f32> {
    let receiver = textureLoad(position, vec2<u32>(centre.xy), 0).xyz;
    let place = texel_of(fit_of(layer_of(receiver)), receiver);
    return vec4(place, 1.0);
}
"#;

/// A slope that fills the picture, and a post beyond it.
fn scene(light: impl Into<LightKind>) -> Arc<Scene> {
    let corners = [
        [-60.0, -3.0, 40.0],
        [60.0, 3.0, 40.0],
        [0.0, 4.0, -160.0],
        [50.0, 0.0, 40.0],
        [50.0, 0.0, 39.0],
        [50.0, 20.0, 40.0],
    ];
    Arc::new(Scene {
        name: "slope".into(),
        mesh: Mesh {
            positions: corners.map(Vec3::from).into(),
            triangles: vec![[0, 1, 2], [3, 4, 5]],
            normals: vec![Vec3::Y],
            normal_indices: vec![[0; 3]; 2],
            ..Mesh::default()
        },
        views: vec![View {
            eye: DVec3::new(1.0, 9.0, 30.0),
            direction: DVec3::new(0.1, -0.5, -1.0),
            fov_y_degrees: 40.0,
            near: 1.0,
            far: 150.0,
            ..View::default()
        }],
        lights: vec![Light::only(light)],
    })
}

/// Holds texels per pixel against half of the way in the map between the pixels on both sides, and
/// above and below. Returns how many pixels that were, and of how many layers.
fn check(fit: &str, light: impl Into<LightKind>) -> (usize, usize) {
    let scene = scene(light);
    let mut provider = provider(&scene, &scene.views[0], VIEWPORT);
    let files = layered(&[("test.ron", DOCUMENT), ("shaders/texel.wgsl", SHADER)]);
    let plan = plan_with(&files, "test.ron", &provider, VIEWPORT, |request| {
        let fit = ParamValue::Choice(fit.into());
        request.params.insert("fit".into(), fit);
    });
    let report = run(
        plan,
        &mut provider,
        &["texel", "texel_density", "map_layer"],
    );
    let layers = values(&report, "map_layer");
    let texels = shares(&report, "texel");
    let texel = |pixel: usize| DVec2::new(texels[4 * pixel].into(), texels[4 * pixel + 1].into());

    let camera = scene.views[0].camera(VIEWPORT);
    let oracle = Oracle::new(&scene.mesh);
    let primitives = oracle.primary(&camera, Progress::default()).unwrap();
    let seen = Seen {
        mesh: &scene.mesh,
        camera: &camera,
        primitives: &primitives,
    };
    let truth = GroundTruthPixels {
        viewport: VIEWPORT,
        classes: vec![Class::Lit; primitives.len()],
        indeterminate: vec![false; primitives.len()],
        n_dot_l: vec![1.0; primitives.len()],
        base_colors: Vec::new(),
    };
    let density = shares(&report, "texel_density");
    let light = &scene.lights[0].kind;
    let footprints = texels::footprints(seen, light, &density, &truth).unwrap();

    let [width, height] = VIEWPORT.map(|edge| edge as usize);
    let (mut checked, mut used_layers) = (0, std::collections::BTreeSet::new());
    for (x, y) in (1..width - 1).flat_map(|x| (1..height - 1).map(move |y| (x, y))) {
        let pixel = x + y * width;
        let around = [pixel - 1, pixel + 1, pixel - width, pixel + width];
        let is_alike =
            |&at: &usize| (layers[at], primitives[at]) == (layers[pixel], 0) && density[at] > 0.0;
        if !(is_alike(&pixel) && around.iter().all(is_alike)) {
            continue;
        }
        let [left, right, above, below] = around.map(texel);
        let area = ((right - left) * 0.5).perp_dot((below - above) * 0.5).abs();
        let per_pixel = footprints[pixel].unwrap().texels();
        assert!(
            (per_pixel / area - 1.0).abs() < 0.02,
            "{fit}, ({x}, {y}): {per_pixel}, but the map has {area}"
        );
        checked += 1;
        used_layers.insert(layers[pixel]);
    }
    (checked, used_layers.len())
}

#[test]
fn texels_per_pixel_are_those_between_pixels() {
    let most = (VIEWPORT[0] * VIEWPORT[1]) as usize * 9 / 10;
    let sun = || DirectionalLight::new(DVec3::new(0.3, -1.0, 0.4));
    for fit in ["scene", "camera", "receivers", "tsm"] {
        let (checked, layers) = check(fit, sun());
        assert!(checked > most && layers == 1, "{fit}: {checked}, {layers}");
    }
    let (checked, layers) = check("pssm", sun());
    assert!(checked > most && layers >= 2, "pssm: {checked}, {layers}");
    let position = DVec3::new(4.0, 14.0, 12.0);
    let spot = SpotLight {
        position,
        direction: DVec3::new(0.2, -1.0, -0.4),
        cone_degrees: 100.0,
        radius: 0.0,
    };
    let (checked, layers) = check("scene", spot);
    assert!(checked > 1000 && layers == 1, "spot: {checked}, {layers}");
    let (checked, layers) = check(
        "scene",
        PointLight {
            position,
            radius: 0.0,
        },
    );
    assert!(checked > most && layers >= 2, "point: {checked}, {layers}");
}

/// Where the eye is the light, and the picture a face of its map, each pixel has the same texels.
#[test]
fn from_the_lights_own_place_all_pixels_have_the_same_texels() {
    let mut scene = Scene::clone(&scene(PointLight {
        position: DVec3::new(1.0, 9.0, 30.0),
        radius: 0.0,
    }));
    scene.views[0].direction = DVec3::NEG_Z;
    scene.views[0].fov_y_degrees = 90.0;
    let scene = Arc::new(scene);
    let viewport = [64, 64];
    let mut provider = provider(&scene, &scene.views[0], viewport);
    let files = layered(&[("test.ron", DOCUMENT), ("shaders/texel.wgsl", SHADER)]);
    let plan = plan_with(&files, "test.ron", &provider, viewport, |request| {
        let size = ParamValue::U32(128);
        request.params.insert("map_size".into(), size);
    });
    let report = run(plan, &mut provider, &["texel_density"]);
    let density = shares(&report, "texel_density");
    let camera = scene.views[0].camera(viewport);
    let primitives = Oracle::new(&scene.mesh)
        .primary(&camera, Progress::default())
        .unwrap();
    let seen = Seen {
        mesh: &scene.mesh,
        camera: &camera,
        primitives: &primitives,
    };
    let truth = GroundTruthPixels {
        viewport,
        classes: vec![Class::Lit; primitives.len()],
        indeterminate: vec![false; primitives.len()],
        n_dot_l: vec![1.0; primitives.len()],
        base_colors: Vec::new(),
    };
    let light = &scene.lights[0].kind;
    let footprints = texels::footprints(seen, light, &density, &truth).unwrap();
    let per_pixel: Vec<f64> = footprints
        .iter()
        .flatten()
        .map(|footprint| footprint.texels())
        .collect();
    assert!(per_pixel.len() > 1000, "{}", per_pixel.len());
    assert!(
        per_pixel.iter().all(|texels| (texels - 4.0).abs() < 1e-3),
        "{per_pixel:?}"
    );
}
