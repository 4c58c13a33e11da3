//! Contact shadows: rays through what the eye sees find casters that the map of another method
//! misses, beside what they stand on.

use crate::support::{
    graphs::{open, provider, run_on, shares, values},
    meshes::foliage,
};
use skiagraph_gpu::FrameReport;
use skiagraph_graph::{Graph, ParamValue, PlanRequest};
use skiagraph_passes::{EmbeddedSources, registry};
use skiagraph_reference::{Class, GroundTruthPixels, Oracle, OracleMode, Progress};
use skiagraph_scene::Scene;
use std::sync::Arc;

const VIEWPORT: [u32; 2] = [128, 128];

type Params<'a> = &'a [(&'a str, ParamValue)];

/// A scene and its ground truth.
struct Case {
    scene: Arc<Scene>,
    truth: GroundTruthPixels,
}

/// One output of a method; `contact@over=pcf` with another document in its open include.
fn report(scene: &Arc<Scene>, method: &str, params: Params, output: &str) -> FrameReport {
    let path = |preset: &str| format!("pipelines/{preset}.ron");
    let (own, over) = method.split_once("@over=").unwrap_or((method, ""));
    let over = (!over.is_empty()).then(|| ("over".to_owned(), path(over)));
    let documents = over.into_iter().collect();
    let graph = Graph::load_over(&path(own), &registry(), &EmbeddedSources, &documents)
        .unwrap_or_else(|errors| panic!("{method}: {errors}"));
    let mut provider = provider(scene, &scene.views[0], VIEWPORT);
    let mut request = PlanRequest::new(VIEWPORT, &provider);
    request.outputs = Some(vec![output.to_owned()]);
    let params = params.iter().cloned();
    request
        .params
        .extend(params.map(|(name, value)| (name.to_owned(), value)));
    let plan = graph
        .plan(&request)
        .unwrap_or_else(|errors| panic!("{method}: {errors}"));
    run_on(&open(), plan, &mut provider, &[output])
}

impl Case {
    fn new(scene: Scene) -> Self {
        let scene = Arc::new(scene);
        let primitives = report(&scene, "shared/gbuffer", &[], "primitive");
        let primitives = values(&primitives, "primitive");
        let camera = scene.views[0].camera(VIEWPORT);
        let (light, how) = (scene.light(), OracleMode::Exact);
        let oracle = Oracle::new(&scene.mesh);
        let shaded = oracle.shade(&camera, light, &primitives, how, Progress::default());
        let truth = shaded.unwrap();
        Self { scene, truth }
    }

    fn visibility(&self, method: &str, params: Params) -> Vec<f32> {
        shares(
            &report(&self.scene, method, params, "visibility"),
            "visibility",
        )
    }

    /// Pixels outside the band that are lit though they are in shadow, and the other way round.
    fn wrong(&self, method: &str, params: Params) -> [usize; 2] {
        let shown = self.visibility(method, params);
        let count = |class: Class, light: f32| {
            let is_wrong = |&pixel: &usize| {
                let truth = &self.truth;
                let is_class = truth.classes[pixel] == class && !truth.indeterminate[pixel];
                is_class && (shown[pixel] - light).abs() < 0.5
            };
            (0..shown.len()).filter(is_wrong).count()
        };
        let counts = [count(Class::Shadow, 1.0), count(Class::Lit, 0.0)];
        println!("{method} {params:?}: {counts:?} wrongly lit, wrongly dark");
        counts
    }
}

fn hard(name: &str) -> Scene {
    skiagraph_cases::case(name).unwrap().scene()
}

fn float(name: &str, value: f32) -> (&str, ParamValue) {
    (name, ParamValue::F32(value))
}

/// Purpose: a bias lifts shadows off what casts them, and the rays put them back. The seen
/// triangles themselves stop rays, so no pixel is darkened that should not be.
#[test]
fn they_close_the_gap_that_a_bias_leaves() {
    let params = [("map_size", ParamValue::U32(128)), float("slope_bias", 2.0)];
    for name in ["box_on_floor", "contact"] {
        let case = Case::new(hard(name));
        let [leaks, dark] = case.wrong("nsm", &params);
        let [closed, still_dark] = case.wrong("contact", &params);
        assert!(
            leaks > 150 && 3 * closed < leaks,
            "{name}: {leaks}, {closed}"
        );
        assert_eq!(still_dark, dark, "{name}");
    }
}

/// Artefact: all that is seen is taken for as thick as `thickness`, and what is thinner shades what
/// the light reaches behind it, the more of it the thicker.
#[test]
fn a_thickness_beyond_the_casters_is_a_false_shadow() {
    let case = Case::new(hard("box_on_floor"));
    let dark = |thickness| {
        let params = [float("reach", 0.3), float("thickness", thickness)];
        case.wrong("contact", &params)[1]
    };
    let [none, thin, thick] = [0.0, 0.01, 0.2].map(dark);
    assert_eq!(none, case.wrong("nsm", &[])[1]);
    assert!(thick > 20 * thin && thin > none, "{none}, {thin}, {thick}");
}

/// Over each method a pixel is as it was, or dark; over a right one nothing changes, nor behind the
/// holes of leaves.
#[test]
fn they_stand_over_any_method() {
    let leaves = Scene {
        mesh: foliage(6, 1.2, 4.0, 5),
        ..hard("near_and_far")
    };
    let box_on_floor = Case::new(hard("box_on_floor"));
    let leaves = Case::new(leaves);
    for (case, method) in [
        (&box_on_floor, "pcf"),
        (&box_on_floor, "vsm"),
        (&box_on_floor, "pssm"),
        (&box_on_floor, "light_buffer"),
        (&leaves, "nsm"),
        (&leaves, "rt"),
    ] {
        let below = case.visibility(method, &[]);
        let above = case.visibility(&format!("contact@over={method}"), &[]);
        let is_exact = ["rt", "light_buffer"].contains(&method);
        for (pixel, (before, after)) in below.iter().zip(&above).enumerate() {
            let is_open = is_exact && !case.truth.indeterminate[pixel];
            assert!(
                after == before || *after == 0.0 && !is_open,
                "{method}, pixel {pixel}: {before}, {after}"
            );
        }
    }
    // Over a soft answer, too, shadows come back that a bias has lifted off their casters.
    let gap = Case::new(hard("contact"));
    let bias = [float("slope_bias", 2.0), ("map_size", ParamValue::U32(128))];
    let below = gap.visibility("pcf", &bias);
    let above = gap.visibility("contact@over=pcf", &bias);
    let darkened = below
        .iter()
        .zip(&above)
        .filter(|(before, after)| after < before);
    assert!(darkened.count() > 100);
}
