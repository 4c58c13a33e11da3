//! How many rounds binning and tracing take, one after the other, on adapters that run 32 threads
//! in step: counted by the shaders themselves, on any adapter. These counts give ten times of a GPU
//! (docs/light_buffer.md).

use crate::support::{
    graphs::{layered, open, plan_with, provider, run_on, values},
    scenes::sponza,
};
use skiagraph_graph::{AdapterFacts, Graph, MemorySources, PlanRequest, Sources as _};
use skiagraph_passes::{EmbeddedSources, registry};
use skiagraph_scene::Scene;
use std::sync::Arc;

/// Rounds of the slowest warp, and of all warps.
type Rounds = [u32; 2];

/// Passes that bin.
const COUNTED: [&str; 3] = ["cull_rounds", "small_rounds", "large_rounds"];

/// Counts the rounds of `cull_clusters`, `bin` and `bin_large` in a frame of Sponza, 1920×1080, as
/// an adapter with these facts runs them; `edit` changes the texts of shared/binning.wgsl and
/// cull_clusters.wgsl.
fn counted(is_software: bool, edit: impl Fn(String) -> String) -> Option<([Rounds; 3], Vec<u32>)> {
    let viewport = [1920, 1080];
    let scene = sponza()?;
    let mut provider = provider(&scene, &scene.views[0], viewport);
    let edited = |path: &str| edit(EmbeddedSources.read(path).unwrap().unwrap().to_string());
    let binning = edited("shaders/shared/binning.wgsl");
    let cull = edited("shaders/cull_clusters.wgsl");
    let files = MemorySources::new([
        ("pipelines/rounds.ron", include_str!("rounds.ron")),
        (
            "shaders/counted_steps.wgsl",
            include_str!("counted_steps.wgsl"),
        ),
        ("shaders/shared/binning.wgsl", &binning),
        ("shaders/cull_clusters.wgsl", &cull),
    ])
    .over(EmbeddedSources);
    let graph = Graph::load("pipelines/rounds.ron", &registry(), &files);
    let graph = graph.unwrap_or_else(|errors| panic!("{errors}"));
    let gpu = open();
    let mut request = PlanRequest::new(viewport, &provider)
        .with_device(gpu.device.limits(), gpu.device.features());
    request.adapter = AdapterFacts {
        is_software,
        ..AdapterFacts::default()
    };
    let plan = graph.plan(&request);
    let plan = plan.unwrap_or_else(|errors| panic!("{errors}"));
    let [cull, small, large] = COUNTED;
    let report = run_on(
        &gpu,
        plan,
        &mut provider,
        &["visibility", cull, small, large],
    );
    let rounds = COUNTED.map(|name| {
        let [slowest, sum, lost] = values(&report, name).try_into().unwrap();
        assert_eq!(
            lost, 0,
            "{name}: more rounds of an outer loop than are counted"
        );
        [slowest, sum]
    });
    Some((rounds, values(&report, "visibility")))
}

#[test]
fn wide_binning_takes_few_rounds_and_answers_the_same() {
    let Some((narrow, expected)) = counted(true, |text| text) else {
        return;
    };
    let (wide, visibility) = counted(false, |text| text).unwrap();
    println!("slowest and all, of cull_clusters, bin and bin_large: {narrow:?}, wide {wide:?}");
    assert!(visibility == expected);
    let sum = |rounds: [Rounds; 3], at: usize| rounds.iter().map(|pass| pass[at]).sum::<u32>();
    assert!(sum(narrow, 0) > 3000 && sum(wide, 0) <= 125);
    assert!(sum(wide, 1) <= 410_000);
}

/// Counts the rounds of the tracer; `edit` changes the text of trace_rays.wgsl.
fn traced(
    scene: &Arc<Scene>,
    viewport: [u32; 2],
    edit: impl Fn(String) -> String,
) -> (u32, Vec<u32>) {
    let path = "shaders/trace_rays.wgsl";
    let tracer = edit(EmbeddedSources.read(path).unwrap().unwrap().to_string());
    let files = layered(&[
        ("pipelines/traced.ron", include_str!("traced.ron")),
        (
            "shaders/counted_steps.wgsl",
            include_str!("counted_steps.wgsl"),
        ),
        (path, &tracer),
    ]);
    let mut provider = provider(scene, &scene.views[0], viewport);
    let plan = plan_with(&files, "pipelines/traced.ron", &provider, viewport, |_| {});
    let report = run_on(&open(), plan, &mut provider, &["visibility", "rounds"]);
    let [_, sum, lost] = values(&report, "rounds").try_into().unwrap();
    assert_eq!(lost, 0, "more rounds of an outer loop than are counted");
    (sum, values(&report, "visibility"))
}

/// The same pixels are lit whichever child comes first.
#[test]
fn any_hit_is_found_sooner_from_the_far_end() {
    let Some(scene) = sponza() else {
        return;
    };
    let viewport = [960, 540];
    let (far, visibility) = traced(&scene, viewport, |text| text);
    let (near, expected) = traced(&scene, viewport, |text| {
        let edited = text.replace("first_found && is_both", "false");
        assert!(edited != text);
        edited
    });
    println!("far first {far}, near first {near}");
    assert!(visibility == expected);
    assert!(f64::from(far) <= 0.93 * f64::from(near));
}

/// Milliseconds of an H200 for a warp's round that waits for the one before, and for any round.
const DEPENDENT: f64 = 0.51e-3;
const ANY: f64 = 0.44e-6;

/// docs/lab/light_buffer.md: `ALONE`, `PART`, and the milliseconds of `bin` and `bin_large`.
const MEASURED: [(u32, u32, [f64; 2]); 5] = [
    (32, 2048, [1.18, 0.811]),
    (8, 512, [0.490, 0.535]),
    (4, 256, [0.253, 0.352]),
    (2, 128, [0.127, 0.237]),
    (1, 64, [0.066, 0.288]),
];

#[test]
#[ignore = "a suite: `./test.sh --all` runs it"]
fn rounds_tell_the_times_of_a_gpu() {
    for (alone, part, measured) in MEASURED {
        let edit = |text: String| {
            let with_alone = text.replace("ALONE: u32 = 32u", &format!("ALONE: u32 = {alone}u"));
            let with_part =
                with_alone.replace("PART: u32 = 2048u", &format!("PART: u32 = {part}u"));
            // No cluster was left out when these were measured.
            with_part.replace("is_live(cluster_boxes[cluster])", "true")
        };
        let Some((rounds, _)) = counted(true, edit) else {
            return;
        };
        let [_, small, large] = rounds;
        for ([slowest, sum], measured) in [small, large].into_iter().zip(measured) {
            let reckoned = DEPENDENT * f64::from(slowest) + ANY * f64::from(sum);
            println!("{alone}, {part}: {slowest}, {sum}: {reckoned:.3} ms, measured {measured} ms");
            assert!(
                (0.75..1.25).contains(&(reckoned / measured)),
                "{alone}, {part}"
            );
        }
    }
}
