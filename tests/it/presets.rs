//! The presets on a small scene against rays traced by hand in f64, and what they make the provider
//! build.

use crate::support;
use crate::support::{
    brute::{self, MISS, Ray},
    graphs::{open, plan, plan_files, provider, run, shares, values},
};
use glam::{DVec3, Vec3};
use skiagraph_gpu::{Executor, device::partial};
use skiagraph_graph::{Code, Graph, ParamValue, PassSummary, PlanRequest};
use skiagraph_passes::{EmbeddedSources, presets, registry};
use skiagraph_scene::{DirectionalLight, Mesh, Scene, View};
use std::sync::Arc;

const VIEWPORT: [u32; 2] = [96, 64];

/// A floor, and a box that floats above it.
fn scene() -> Arc<Scene> {
    let view = View {
        eye: DVec3::new(0.5, 5.0, 7.0),
        direction: DVec3::new(0.0, -0.7, -1.0),
        fov_y_degrees: 50.0,
        near: 0.5,
        far: 50.0,
        ..View::default()
    };
    Arc::new(Scene {
        name: "box".into(),
        mesh: support::meshes::box_over_floor(4.0, Vec3::new(1.0, 0.4, 1.0)),
        views: vec![view],
        lights: vec![DirectionalLight::new(DVec3::new(-0.4, -1.0, 0.3)).into()],
    })
}

/// Answer of a pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
enum GroundTruthPixel {
    Background,
    FacingAway,
    Lit,
    Shadow,
    /// Too near a silhouette, a contour or a border for f32.
    Unsure,
}

impl GroundTruthPixel {
    fn is_settled(self) -> bool {
        self != Self::Unsure
    }
}

/// How near a border a ray must pass, as a share of the triangle, to count as unsure.
fn ground_truth(scene: &Scene, border: f64) -> Vec<GroundTruthPixel> {
    let camera = scene.views[0].camera(VIEWPORT);
    let to_light = scene.light().towards(glam::DVec3::ZERO).direction;
    let answer = |ray: &Ray, skip| {
        let outer = brute::hits(&scene.mesh, ray, skip, -border);
        let inner = brute::hits(&scene.mesh, ray, skip, border);
        (outer.first().map(|hit| hit.primitive) == inner.first().map(|hit| hit.primitive))
            .then(|| inner.first().copied())
    };
    let pixel = |x, y| {
        let direction = camera.pixel_direction(x, y);
        let ray = Ray {
            origin: camera.eye.as_vec3(),
            t_min: 0.0,
            direction: direction.as_vec3(),
            t_max: 50.0,
        };
        let Some(seen) = answer(&ray, MISS) else {
            return GroundTruthPixel::Unsure;
        };
        let Some(seen) = seen else {
            return GroundTruthPixel::Background;
        };
        if scene.mesh.corner_normals(seen.primitive)[0].dot(to_light) <= 0.0 {
            return GroundTruthPixel::FacingAway;
        }
        let position = camera.eye + direction * seen.t;
        let ray = Ray {
            origin: position.as_vec3(),
            t_min: 0.0,
            direction: to_light.as_vec3(),
            t_max: 50.0,
        };
        match answer(&ray, seen.primitive) {
            None => GroundTruthPixel::Unsure,
            Some(None) => GroundTruthPixel::Lit,
            Some(Some(_)) => GroundTruthPixel::Shadow,
        }
    };
    (0..VIEWPORT[1])
        .flat_map(|y| (0..VIEWPORT[0]).map(move |x| (x, y)))
        .map(|(x, y)| pixel(x, y))
        .collect()
}

fn count(ground_truth: &[GroundTruthPixel], which: GroundTruthPixel) -> usize {
    ground_truth.iter().filter(|&&t| t == which).count()
}

#[test]
fn rt_agrees_with_rays_traced_by_hand() {
    let ground_truth = ground_truth(&scene(), 1e-4);
    // All kinds of pixels occur, and nearly all are settled.
    for kind in [
        GroundTruthPixel::Background,
        GroundTruthPixel::FacingAway,
        GroundTruthPixel::Lit,
        GroundTruthPixel::Shadow,
    ] {
        assert!(
            count(&ground_truth, kind) > 50,
            "{kind:?}: {}",
            count(&ground_truth, kind)
        );
    }
    assert!(count(&ground_truth, GroundTruthPixel::Unsure) < ground_truth.len() / 50);

    for per_pixel in [false, true] {
        let scene = scene();
        let mut provider = provider(&scene, &scene.views[0], VIEWPORT);
        let plan = plan("pipelines/rt.ron", &provider, VIEWPORT, |request| {
            request
                .params
                .insert("per_pixel".into(), ParamValue::Bool(per_pixel));
        });
        let report = run(plan, &mut provider, &["visibility", "status", "ray_count"]);
        let (visibility, status) = (values(&report, "visibility"), values(&report, "status"));
        for (index, &ground_truth) in ground_truth
            .iter()
            .enumerate()
            .filter(|(_, ground_truth)| ground_truth.is_settled())
        {
            let expected = match ground_truth {
                GroundTruthPixel::Background => (1, 0),
                GroundTruthPixel::FacingAway => (0, 1),
                GroundTruthPixel::Lit => (1, 4),
                GroundTruthPixel::Shadow | GroundTruthPixel::Unsure => (0, 4),
            };
            assert_eq!(
                (visibility[index], status[index]),
                expected,
                "pixel {index}, {ground_truth:?}, per pixel: {per_pixel}"
            );
        }
        let asked = status.iter().filter(|&&status| status == 4).count();
        let rays = values(&report, "ray_count")[0] as usize;
        assert_eq!(rays, if per_pixel { ground_truth.len() } else { asked });
    }
}

/// Casters that one buffer does not hold are drawn in turns: here five triangles each of fourteen.
#[test]
fn casters_in_turns_make_the_layers_that_they_make_at_once() {
    const OUTPUTS: [&str; 2] = ["visibility", "status"];
    for preset in ["crsm", "crsm_depth", "crsma", "crsma_full"] {
        let answers = |corners: u32| {
            let document = format!(
                r#"(
                    format: 3,
                    extends: "{preset}.ron",
                    set: {{"map_size": 64}},
                    materials: [Buffer(name: "casters", count: {corners})],
                )"#
            );
            let scene = scene();
            let mut provider = provider(&scene, &scene.views[0], VIEWPORT);
            let plan = plan_files(&[("test.ron", &document)], &provider, VIEWPORT);
            let is_turn = |pass: &&PassSummary| pass.name.ends_with(".inner");
            let turns = plan.passes().iter().filter(is_turn).count();
            let report = run(plan, &mut provider, &OUTPUTS);
            (turns, OUTPUTS.map(|name| values(&report, name)))
        };
        let (once, at_once) = answers(3 * 14);
        let (turns, in_turns) = answers(3 * 5);
        assert_eq!((once, turns), (1, 3), "{preset}");
        assert_eq!(in_turns, at_once, "{preset}");
        let certain = at_once[1].iter().filter(|&&status| status == 3).count();
        assert!(certain > 50, "{preset} is certain of {certain} shadows");
    }
}

/// Rays of more pixels than one buffer holds are traced in turns: here of a thousand each, the last
/// turn being short.
#[test]
fn pixels_in_turns_get_the_answers_that_they_get_at_once() {
    const OUTPUTS: [&str; 3] = ["visibility", "status", "ray_count"];
    for (preset, set) in [
        ("rt", r#""per_pixel": false"#),
        ("rt", r#""per_pixel": true"#),
        ("hybrid_pcf", r#""map_size": 64"#),
        ("crsm", r#""map_size": 64"#),
        ("crsm_single", r#""map_size": 64"#),
        ("crsm_depth", r#""map_size": 64"#),
    ] {
        let answers = |most: u32| {
            let document = format!(
                r#"(
                    format: 3,
                    extends: "{preset}.ron",
                    set: {{{set}}},
                    values: {{"most": "min(status.count, {most})"}},
                )"#
            );
            let scene = scene();
            let mut provider = provider(&scene, &scene.views[0], VIEWPORT);
            let plan = plan_files(&[("test.ron", &document)], &provider, VIEWPORT);
            let turns = plan
                .passes()
                .iter()
                .filter(|pass| pass.name.ends_with("fix_pixels"))
                .count();
            let report = run(plan, &mut provider, &OUTPUTS);
            (turns, OUTPUTS.map(|name| values(&report, name)))
        };
        let (once, at_once) = answers(1 << 22);
        let (turns, in_turns) = answers(1000);
        assert_eq!((once, turns), (1, 7), "{preset}");
        assert!(
            at_once[2][0] > 20,
            "{preset} {set} traced {} rays",
            at_once[2][0]
        );
        assert_eq!(in_turns, at_once, "{preset}, {set}");
    }
}

#[test]
fn nsm_is_wrong_at_contours_only_and_less_so_on_a_finer_map() {
    // A contour may be off by a texel or so: 12 % of a face of the box at a map of 32 texels' edge.
    let settled = ground_truth(&scene(), 0.12);
    let strict = ground_truth(&scene(), 1e-4);
    let mut wrong = vec![];
    for map_size in [32, 1024] {
        let scene = scene();
        let mut provider = provider(&scene, &scene.views[0], VIEWPORT);
        let plan = plan("pipelines/nsm.ron", &provider, VIEWPORT, |request| {
            request
                .params
                .insert("map_size".into(), ParamValue::U32(map_size));
        });
        let report = run(plan, &mut provider, &["visibility", "status"]);
        let (visibility, status) = (values(&report, "visibility"), values(&report, "status"));
        let expected = |ground_truth| match ground_truth {
            GroundTruthPixel::Background => (1, 0),
            GroundTruthPixel::FacingAway => (0, 1),
            GroundTruthPixel::Lit => (1, 2),
            GroundTruthPixel::Shadow | GroundTruthPixel::Unsure => (0, 3),
        };
        for (index, &ground_truth) in settled
            .iter()
            .enumerate()
            .filter(|(_, ground_truth)| ground_truth.is_settled())
        {
            assert_eq!(
                (visibility[index], status[index]),
                expected(ground_truth),
                "pixel {index}, {ground_truth:?}, map {map_size}"
            );
        }
        let pixels = strict
            .iter()
            .enumerate()
            .filter(|(_, ground_truth)| ground_truth.is_settled());
        wrong.push(
            pixels
                .filter(|(index, ground_truth)| visibility[*index] != expected(**ground_truth).0)
                .count(),
        );
    }
    assert!(
        wrong[0] > 0 && wrong[1] * 4 < wrong[0],
        "{wrong:?} wrong pixels"
    );
}

#[test]
fn only_a_traced_graph_builds_a_hierarchy() {
    for (preset, traces) in [("nsm", false), ("rt", true)] {
        let scene = scene();
        let mut provider = provider(&scene, &scene.views[0], VIEWPORT);
        let plan = plan(
            &format!("pipelines/{preset}.ron"),
            &provider,
            VIEWPORT,
            |_| (),
        );
        assert_eq!(
            plan.provided().iter().any(|name| name.contains("bvh")),
            traces,
            "{preset}"
        );
        run(plan, &mut provider, &[]);
        assert_eq!(
            provider
                .built()
                .iter()
                .any(|built| built.name.contains("bvh")),
            traces,
            "{preset}: {:?}",
            provider.built()
        );
    }
}

#[test]
fn an_empty_scene_is_all_background() {
    // No software adapter has the hardware that this one asks for.
    for preset in presets().iter().filter(|preset| preset.name != "crsm_hw") {
        let scene = Arc::new(Scene {
            mesh: Mesh::default(),
            ..Scene::clone(&scene())
        });
        let mut provider = provider(&scene, &scene.views[0], VIEWPORT);
        let plan = plan(&preset.path, &provider, VIEWPORT, |_| ());
        let has_status = plan.outputs().iter().any(|output| output.name == "status");
        let outputs = if has_status {
            &["visibility", "status"][..]
        } else {
            &["visibility"]
        };
        let report = run(plan, &mut provider, outputs);
        assert!(
            shares(&report, "visibility")
                .iter()
                .all(|&visibility| visibility == 1.0),
            "{}",
            preset.name
        );
        assert!(
            !has_status || values(&report, "status").iter().all(|&status| status == 0),
            "{}",
            preset.name
        );
    }
}

#[test]
fn two_graphs_share_what_the_provider_built() {
    let gpu = open();
    let scene = scene();
    let mut provider = provider(&scene, &scene.views[0], VIEWPORT);
    let executors: Vec<Executor> = ["rt", "nsm"]
        .map(|preset| {
            plan(
                &format!("pipelines/{preset}.ron"),
                &provider,
                VIEWPORT,
                |_| (),
            )
        })
        .into_iter()
        .map(|plan| Executor::on(&gpu, plan, &mut provider).unwrap())
        .collect();
    assert_eq!(executors.len(), 2);
    let again = provider.built().iter().find(|built| built.times > 1);
    assert_eq!(again, None);
}

#[test]
fn a_param_that_only_uniforms_hold_needs_no_other_plan() {
    let scene = scene();
    let provider = provider(&scene, &scene.views[0], VIEWPORT);
    let mut written = Vec::new();
    for preset in presets() {
        let path = format!("pipelines/{}.ron", preset.name);
        let mut plan = plan(&path, &provider, VIEWPORT, |request| {
            request.any_adapter = true
        });
        let graph = Graph::load(&path, &registry(), &EmbeddedSources).unwrap();
        for param in graph.params() {
            let name = &param.name.value;
            let Some(ParamValue::F32(value)) = plan.param(name) else {
                continue;
            };
            let other = ParamValue::F32(value * 0.5 + 0.25);
            if plan.is_in_uniforms(name, &other) {
                let changed = plan.set_in_uniforms(name, other.clone());
                let what = format!("{}: {name}", preset.name);
                assert!(plan.is_same_with(name, other), "{what}");
                written.extend((!changed.is_empty()).then_some(what));
            }
        }
    }
    assert!(written.contains(&"nsm: bias".to_owned()), "{written:?}");
}

/// GL gives less than WebGPU: what was not compared there is refused before anything is made.
#[test]
fn on_gl_only_what_is_proven_there_is_planned() {
    let scene = scene();
    let provider = provider(&scene, &scene.views[0], VIEWPORT);
    let mut request = PlanRequest::new(VIEWPORT, &provider);
    request.limits = open().device.limits();
    request.features = wgpu::Features::all();
    request.partial_backend = partial(wgpu::Backend::Gl);
    assert!(partial(wgpu::Backend::Vulkan).is_none());
    let mut proven = Vec::new();
    for preset in presets() {
        let graph = Graph::load(&preset.path, &registry(), &EmbeddedSources);
        let graph = graph.unwrap_or_else(|error| panic!("{error}"));
        match graph.plan(&request) {
            Ok(_) => proven.push(preset.name),
            Err(refused) => {
                let codes = refused.iter().map(|mistake| mistake.code);
                assert_eq!(codes.collect::<Vec<_>>(), [Code::Feature], "{refused}");
                let text = refused.to_string();
                assert!(
                    text.contains(&preset.path) && text.contains("backend gl"),
                    "{text}"
                );
            }
        }
    }
    // .ci/run compares these with the reference on GL.
    assert_eq!(proven, ["light_buffer", "rt"]);
}
