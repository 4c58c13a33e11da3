//! The methods of `tests/foreign/engine`, first written in format 2: each answers as it did then
//! (`tests/foreign/README.md` has both figures).

use super::{FOLDER, plan};
use crate::support::{
    graphs::{self, frame, open, shares, values},
    scenes::load,
};
use skiagraph_gpu::{Executor, FrameReport};
use skiagraph_graph::ParamValue;
use skiagraph_passes::SceneProvider;
use skiagraph_reference::{
    Graded, GroundTruth, Oracle, OracleMode, Progress, Statistics, ground_truth,
};
use skiagraph_scene::{LightKind, Scene, View};
use std::sync::Arc;

const VIEWPORT: [u32; 2] = [128, 128];

type Params<'a> = &'a [(&'a str, ParamValue)];

/// A view of a scene under one of its lights.
struct Bench {
    scene: Arc<Scene>,
    view: View,
    light: LightKind,
}

impl Bench {
    fn new(scene: &str, view: &str, light: &str) -> Self {
        let scene = load(scene);
        let named = scene.views.iter().find(|other| other.name == view);
        let view = named.expect("the scene has the view").clone();
        let lights = scene.lights_of(&view);
        let named = lights.iter().find(|other| other.name == light);
        let light = named.unwrap_or(&lights[0]).kind;
        Self { scene, view, light }
    }

    /// The park under a sun five degrees wide.
    fn soft() -> Self {
        let scene = format!("{FOLDER}/engine/scenes/soft_walk.ron");
        Self::new(&scene, "bench", "")
    }

    fn provider(&self) -> SceneProvider {
        let mut provider = graphs::provider(&self.scene, &self.view, VIEWPORT);
        provider.set_light(self.light);
        provider
    }

    fn ground_truth(&self) -> GroundTruth {
        let gbuffer = "pipelines/shared/gbuffer.ron";
        let primitives = values(&self.frames(gbuffer, &[], 1, &["primitive"]), "primitive");
        let camera = self.view.camera(VIEWPORT);
        let (how, progress) = ((OracleMode::Exact, 512), Progress::default());
        ground_truth(
            &Oracle::new(&self.scene.mesh),
            &camera,
            self.light,
            &primitives,
            how,
            progress,
        )
        .unwrap_or_else(|error| panic!("{error}"))
    }

    /// Returns the report of the last of some frames.
    fn frames(&self, path: &str, params: Params, frames: usize, outputs: &[&str]) -> FrameReport {
        let mut provider = self.provider();
        let plan = plan(path, &provider, VIEWPORT, |request| {
            request.outputs = Some(outputs.iter().map(|&name| name.into()).collect());
            let params = params.iter().cloned();
            request
                .params
                .extend(params.map(|(name, value)| (name.to_owned(), value)));
        });
        let gpu = open();
        let mut executor = Executor::on(&gpu, plan, &mut provider)
            .unwrap_or_else(|error| panic!("{path}: {error}"));
        for _ in 1..frames {
            frame(&gpu, &mut executor, &[]);
        }
        frame(&gpu, &mut executor, outputs)
    }
}

const MAP: Params = &[("map_size", ParamValue::U32(512))];

/// Pixels that are wrong, percent, once buffers that grow have room.
fn are_wrong(bench: &Bench, methods: &[(&str, f64)]) {
    let ground_truth = bench.ground_truth();
    for &(method, percent) in methods {
        let path = format!("engine/{method}.ron");
        let report = bench.frames(&path, MAP, 4, &["visibility", "status"]);
        let (visibility, status) = (values(&report, "visibility"), values(&report, "status"));
        let counts = Statistics::judged(&visibility, &status, &ground_truth.pixels)
            .unwrap_or_else(|error| panic!("{path}: {error}"));
        let share = 100.0 * counts.wrong_share();
        println!("{path}: {share:.4} %, {percent} % expected");
        assert!((share - percent).abs() < 0.05, "{path}: {share} %");
    }
}

/// Root mean square errors of documents with these params, after some frames; each with what is
/// expected.
fn errors<'a>(methods: &[(&'a str, Params, f64)], frames: usize) -> Vec<(&'a str, f64, f64)> {
    let bench = Bench::soft();
    let ground_truth = bench.ground_truth();
    let error = |&(path, params, expected): &(&'a str, Params, f64)| {
        let report = bench.frames(path, params, frames, &["visibility"]);
        let shown = shares(&report, "visibility");
        let graded = Graded::judged(&shown, &ground_truth.shares(), &ground_truth.pixels)
            .unwrap_or_else(|error| panic!("{path}: {error}"));
        println!("{path}: RMSE {:.5}, {expected} expected", graded.rmse);
        (path, graded.rmse, expected)
    };
    methods.iter().map(error).collect()
}

fn are_off(methods: &[(&str, Params, f64)], frames: usize) {
    for (path, rmse, expected) in errors(methods, frames) {
        assert!((rmse - expected).abs() < 1e-3, "{path}: {rmse}");
    }
}

#[test]
fn methods_of_the_sun_are_as_wrong_as_in_format_2() {
    let bench = Bench::new("park", "bench_side", "");
    let methods = [("rtwsm", 4.815), ("virtual_map", 8.678)];
    are_wrong(&bench, &methods);
}

#[test]
fn the_method_of_a_bulb_is_as_wrong_as_in_format_2() {
    let lamps = concat!(env!("CARGO_MANIFEST_DIR"), "/../scenes/lamps.ron");
    let bench = Bench::new(lamps, "bench", "bulb");
    are_wrong(&bench, &[("dual_paraboloid", 3.355)]);
}

#[test]
fn soft_methods_are_as_far_off_as_in_format_2() {
    are_off(&[("engine/deferred_blur.ron", MAP, 0.17164)], 1);
}

/// The presets against the author's versions of the same methods, which they replace.
#[test]
fn soft_presets_are_no_farther_off_than_the_authors_versions() {
    let methods = [
        ("pipelines/msm.ron", MAP, 0.18069),
        ("pipelines/evsm.ron", MAP, 0.19444),
        ("pipelines/pcss.ron", MAP, 0.16927),
    ];
    for (path, rmse, expected) in errors(&methods, 1) {
        assert!(rmse < expected + 1e-3, "{path}: {rmse}");
    }
}

/// After as many frames as the light has points.
#[test]
fn methods_that_remember_are_as_far_off_as_in_format_2() {
    let methods = [
        ("engine/svgf.ron", &[][..], 0.05636),
        ("engine/svgf_moving.ron", &[], 0.05636),
        ("engine/stochastic.ron", MAP, 0.11711),
    ];
    are_off(&methods, 16);
}

/// There is no reference of occlusion: the mean over all pixels.
#[test]
fn occlusion_is_that_of_format_2() {
    let report = Bench::soft().frames("engine/rtao.ron", &[], 16, &["visibility"]);
    let open = shares(&report, "visibility");
    let mean = open.iter().map(|&share| f64::from(share)).sum::<f64>() / open.len() as f64;
    println!("{mean:.5}");
    assert!((mean - 0.87099).abs() < 5e-4, "{mean}");
}

/// Lines of RON that are neither blank nor a comment.
fn lines(method: &str) -> usize {
    let text = std::fs::read_to_string(format!("{FOLDER}/engine/{method}.ron"));
    let text = text.unwrap_or_else(|error| panic!("{method}: {error}"));
    let says = |line: &&str| !line.is_empty() && !line.starts_with("//");
    text.lines().map(str::trim).filter(says).count()
}

/// Lines of the documents of format 2, wrapped at 120 columns as those of format 3 are.
const WRAPPED: usize = 230;

#[test]
fn the_documents_are_as_long_as_the_readme_says() {
    let readme = std::fs::read_to_string(format!("{FOLDER}/README.md")).expect("it is there");
    let (_, engine) = readme.split_once("\n## ").expect("its section");
    let (mut rows, mut sum) = (0, [0, 0]);
    let number = |text: &str| text.parse::<usize>().expect("a number");
    let table = engine.lines().filter(|line| line.starts_with("| "));
    for row in table.skip(1) {
        let cells: Vec<&str> = row.split('|').map(str::trim).collect();
        let (method, counts) = (cells[1], cells[2].split_once(" → ").expect("before → now"));
        let (before, now) = (number(counts.0), number(counts.1));
        if method == "together" {
            assert_eq!([before, now], sum);
            assert!(4 * now <= 3 * WRAPPED, "a quarter shorter than format 2");
            continue;
        }
        assert_eq!(now, lines(method), "{method}");
        sum = [sum[0] + before, sum[1] + now];
        rows += 1;
    }
    assert_eq!(rows, 9);
}
