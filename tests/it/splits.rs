//! Maps over splits of the eye's frustum, and over a trapezoid around it: what they are for, and
//! what they are known to do wrong.

use crate::support::{
    bench::{Answers, Bench},
    graphs::{Extended, plan, provider, run, run_files},
    random::Random,
};
use glam::{DMat3, DVec2, DVec3, Vec2, Vec3};
use skiagraph_graph::ParamValue;
use skiagraph_passes::SceneProvider;
use skiagraph_reference::{Class, Statistics};
use skiagraph_scene::{DirectionalLight, Mesh, Scene, SceneLibrary};
use skiagraph_tests::cpu_reference::trapezoid::{normalization, trapezoid};
use std::sync::Arc;

pub(crate) const VIEWPORT: [u32; 2] = [256, 160];

pub(crate) fn word(word: &str) -> ParamValue {
    ParamValue::Choice(word.to_owned())
}

/// The avenue under one of its views, whose light is the scene's then.
pub(crate) fn avenue(view: &str) -> Arc<Scene> {
    let (mut scene, _) = SceneLibrary::default().load("avenue").unwrap();
    let view = scene.view(view).unwrap().clone();
    scene.lights = scene.lights_of(&view);
    scene.views = vec![view];
    Arc::new(scene)
}

pub(crate) fn wrong(counts: &Statistics) -> u64 {
    counts.wrong.total - counts.wrong.in_band
}

/// By hand: sides that meet at (0, 2), from a top line at y = 1 of width 2 to a base line at
/// y = −1 of width 6; the same sheared by one to the right per unit down, and turned by a quarter.
#[test]
fn trapezoids_by_hand() {
    let [a, b] = [1.0, 3.0];
    let corners = [[-b, -1.0], [b, -1.0], [a, 1.0], [-a, 1.0]].map(DVec2::from);
    // x / (2 − y) and (2 y − 1) / (2 − y).
    let by_hand = DMat3::from_cols_array_2d(&[[1.0, 0.0, 0.0], [0.0, 2.0, -1.0], [0.0, -1.0, 2.0]]);
    same(normalization(corners), by_hand);
    let sheared =
        DMat3::from_cols_array_2d(&[[1.0, 0.0, 0.0], [1.0, 2.0, -1.0], [-1.0, -1.0, 2.0]]);
    same(
        normalization(corners.map(|p| DVec2::new(p.x + 1.0 - p.y, p.y))),
        sheared,
    );
    let quarter = DMat3::from_cols_array_2d(&[[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]);
    same(normalization(corners.map(DVec2::perp)), by_hand * quarter);
    // A frustum that is this trapezoid seen from the side, and the focus for which its own sides
    // are the trapezoid's: 4 · 0.4 f / (3.2 − 4 f) = 1.
    let frustum = [
        [-a, 1.0],
        [a, 1.0],
        [-a, 1.0],
        [a, 1.0],
        [-b, -1.0],
        [b, -1.0],
        [-b, -1.0],
        [b, -1.0],
    ];
    let quad = trapezoid(frustum.map(DVec2::from), 4.0 / 7.0).unwrap();
    for (corner, wanted) in quad.into_iter().zip(corners) {
        assert!(corner.distance(wanted) < 1e-12, "{corner} {wanted}");
    }
}

/// But for a factor.
fn same(matrix: DMat3, wanted: DMat3) {
    let factor = matrix.z_axis.z / wanted.z_axis.z;
    assert!(
        matrix.abs_diff_eq(wanted * factor, 1e-12 * factor.abs()),
        "{matrix} {wanted}"
    );
}

const TRAPEZOID: &str = r#"
#import "shared/trapezoid.wgsl"
struct Params { warp: f32 }
var<uniform> params: Params;
var<storage, read> test_corners: array<vec2<f32>>;
var<storage, read_write> maps: array<array<f32, 10>>;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) thread: vec3<u32>) {
    if thread.x >= arrayLength(&maps) {
        return;
    }
    var corners: array<vec2<f32>, 8>;
    for (var corner = 0u; corner < 8u; corner++) {
        corners[corner] = test_corners[8u * thread.x + corner];
    }
    let map = trapezoid_map(corners, params.warp);
    maps[thread.x] = array(
        map.x.x, map.x.y, map.x.z, map.y.x, map.y.y, map.y.z, map.w.x, map.w.y, map.w.z,
        select(0.0, 1.0, map.exists),
    );
}
"#;

/// Random frusta under a light from above: the shader's closed form is the product of the paper's
/// matrices, the frustum is within the square, and the focus where the 80 % rule wants it.
#[test]
fn the_shaders_trapezoid_is_the_papers() {
    const FRUSTA: usize = 200;
    let mut random = Random(3);
    let mut unit = || f64::from(random.vector().x);
    let frusta: Vec<[Vec2; 8]> = (0..FRUSTA)
        .map(|_| {
            let forward = DVec3::new(unit(), 1.2 * unit(), unit()).normalize();
            let right = forward.any_orthonormal_vector();
            let up = right.cross(forward);
            let far = 20.0 + 15.0 * unit();
            std::array::from_fn(|corner| {
                let sign = |bit: usize| if corner & bit == 0 { -0.5 } else { 0.5 };
                let distance = if corner < 4 { 1.0 } else { far };
                let p = distance * (forward + sign(1) * right + sign(2) * up);
                DVec2::new(p.x, p.z).as_vec2()
            })
        })
        .collect();
    let scene = Scene {
        name: "none".into(),
        mesh: Mesh::default(),
        views: vec![],
        lights: vec![DirectionalLight::new(DVec3::NEG_Y).into()],
    };
    for focus in [0.05, 0.3, 0.95] {
        let mut provider = Extended::new(SceneProvider::new(Arc::new(scene.clone())));
        provider.add("test.corners", frusta.as_flattened());
        let document = format!(
            r#"(
                format: 3,
                materials: [Buffer(name: "maps", count: {FRUSTA})],
                passes: [Compute(name: "map", dispatch: Over({FRUSTA}), set: {{"warp": {focus}}})],
                outputs: ["maps"],
            )"#
        );
        let files = [("test.ron", document.as_str()), ("map.wgsl", TRAPEZOID)];
        let bytes = run_files(&files, &mut provider, "maps");
        let maps: Vec<[f32; 10]> = bytemuck::pod_collect_to_vec(&bytes);
        let mut trapezoids = 0;
        for (frustum, map) in frusta.iter().zip(maps) {
            let corners = frustum.map(|corner| corner.as_dvec2());
            let Some(corners_there) = trapezoid(corners, focus) else {
                assert_eq!(map[9], 0.0);
                continue;
            };
            assert_eq!(map[9], 1.0);
            trapezoids += 1;
            let shaders = |p: DVec2| {
                let row = |at: usize| {
                    p.x * f64::from(map[at]) + p.y * f64::from(map[at + 1]) + f64::from(map[at + 2])
                };
                DVec2::new(row(0), row(3)) / row(6)
            };
            let papers = normalization(corners_there);
            let centre = |corners: &[DVec2]| corners.iter().sum::<DVec2>() / 4.0;
            let [near, far] = [centre(&corners[..4]), centre(&corners[4..])];
            for p in corners.into_iter().chain(corners_there).chain([near, far]) {
                let wanted = papers * p.extend(1.0);
                let wanted = wanted.truncate() / wanted.z;
                assert!(
                    shaders(p).distance(wanted) < 2e-3,
                    "{p}: {wanted} {}",
                    shaders(p)
                );
            }
            for corner in corners {
                assert!(shaders(corner).abs().max_element() < 1.001, "{corner}");
            }
            // Unless it asks for more than a rectangle gives.
            let focused = shaders(near.lerp(far, focus)).y;
            assert!(focused > -0.601 || focus > 0.7, "{focused}");
            assert!(focused < -0.599 || focus > 0.7, "{focused}");
        }
        assert!((40..FRUSTA).contains(&trapezoids), "{trapezoids}");
    }
}

/// Purpose of splits: on a scene 2,000 units long a map of 1024² does not do, warped or split it
/// does better.
#[test]
fn warped_and_split_maps_are_right_more_often() {
    for view in ["along", "high"] {
        let scene = avenue(view);
        let mut bench = Bench::new(&scene, VIEWPORT);
        let mut counts = |preset: &str| wrong(&bench.judge(preset, &[]));
        let [nsm, tsm, pssm] = ["nsm", "tsm", "pssm"].map(&mut counts);
        println!("{view}: nsm {nsm}, tsm {tsm}, pssm {pssm}");
        assert!(
            8 * tsm < 7 * nsm && 2 * pssm < nsm,
            "{view}: {nsm} {tsm} {pssm}"
        );
    }
}

/// Proven answers do not depend on the split that a receiver asks.
#[test]
#[ignore = "a suite: `./test.sh --all` runs it"]
fn split_maps_are_exact_where_one_map_is() {
    for view in ["along", "duel"] {
        let scene = avenue(view);
        let mut bench = Bench::new(&scene, VIEWPORT);
        for preset in ["crsm", "crsma_full", "light_buffer"] {
            for (splits, fit_to_receivers) in [(2, false), (5, true)] {
                let params = [
                    ("fit", word("pssm")),
                    ("map_size", ParamValue::U32(256)),
                    ("splits", ParamValue::U32(splits)),
                    ("fit_to_receivers", ParamValue::Bool(fit_to_receivers)),
                ];
                let counts = bench.judge(preset, &params);
                assert_eq!(wrong(&counts), 0, "{view} {preset} {splits}: {counts:?}");
                assert!(counts.indeterminate_share() < 5e-3, "{counts:?}");
            }
        }
    }
}

/// Seams: a split's texels are as large at its near end as at its far one, so behind each plane
/// between two splits pixels are wrong more often than before it.
#[test]
fn where_splits_meet_their_errors_jump() {
    const SPLITS: usize = 4;
    let scene = avenue("along");
    let viewport = [512, 320];
    let mut bench = Bench::new(&scene, viewport);
    let params = [
        ("split", word("logarithmic")),
        ("splits", ParamValue::U32(SPLITS as u32)),
        ("fit_distance", ParamValue::F32(1000.0)),
    ];
    let answers = bench.answers("pssm", &params);
    let distances = distances(&scene, viewport);
    let near = scene.views[0].near;
    let planes = (1..SPLITS).map(|i| near * (1000.0 / near).powf(i as f64 / SPLITS as f64));
    // Before the first one the eye sees nothing but the ground in front of its feet.
    for plane in planes.skip(1) {
        let [before, behind] = [[plane / 1.25, plane], [plane, plane * 1.25]]
            .map(|between| wrong_share(&answers, &distances, between));
        println!("at {plane:.1}: {before:.4} before, {behind:.4} behind");
        assert!(behind > 1.3 * before, "{plane}: {before} {behind}");
    }
}

/// How far from the eye each pixel's receiver is, along the view.
pub(crate) fn distances(scene: &Arc<Scene>, viewport: [u32; 2]) -> Vec<f64> {
    let view = &scene.views[0];
    let mut provider = provider(scene, view, viewport);
    let plan = plan("pipelines/shared/gbuffer.ron", &provider, viewport, |_| {});
    let report = run(plan, &mut provider, &["position"]);
    let positions = report.readbacks[0].content.as_f32().unwrap();
    let forward = view.direction.normalize();
    positions
        .chunks_exact(4)
        .map(|texel| forward.dot(Vec3::from_slice(texel).as_dvec3() - view.eye))
        .collect()
}

/// Returns the share of wrong pixels among those that face the light at such a distance.
pub(crate) fn wrong_share(answers: &Answers, distances: &[f64], between: [f64; 2]) -> f64 {
    let (mut wrong, mut counted) = (0.0, 0.0);
    for (pixel, class) in answers.truth.classes.iter().enumerate() {
        if class.faces_light() && (between[0]..between[1]).contains(&distances[pixel]) {
            counted += 1.0;
            let lit = *class == Class::Lit;
            wrong += f64::from(u8::from(lit != (answers.visibility[pixel] == 1)));
        }
    }
    assert!(counted > 200.0, "{between:?}: {counted}");
    wrong / counted
}

/// Duelling frusta: where the light shines into the eye no trapezoid is better than a rectangle,
/// and `tsm` falls back to one; from aside it has a fraction of its wrong pixels.
#[test]
fn against_the_light_a_trapezoid_gains_nothing() {
    let share = |view: &str| {
        let scene = avenue(view);
        let mut bench = Bench::new(&scene, VIEWPORT);
        let tsm = wrong(&bench.judge("tsm", &[]));
        let eye = wrong(&bench.judge("nsm", &[("fit", word("camera"))]));
        println!("{view}: tsm {tsm}, nsm over the eye's frustum {eye}");
        tsm as f64 / eye as f64
    };
    assert!(share("along") < 0.6);
    assert!(share("duel") > 0.9);
}
