//! Results in a folder, and going on from those that are there.

use crate::support::{LIT, NOWHERE, comparison, keep, park, park_comparison, sources, timed};
use crate::timeless::timeless;
use serde_json::Value;
use skiagraph_compare::{
    comparison::Comparison, graphs::shadow_method::load_methods, measuring::resume::Kept,
};
use skiagraph_graph::Sources;
use skiagraph_passes::EmbeddedSources;
use std::{fs, path::Path};

/// Compares methods, those of a folder first, and keeps the results in a folder; returns what was
/// heard, and the file.
fn compare(
    methods: &[&str],
    map_sizes: &[u32],
    own: &Path,
    out: &Path,
    kept: Kept,
) -> (String, Vec<String>, Value) {
    let mut comparison = comparison(park(), methods, own, map_sizes);
    comparison.viewports = vec![[24, 16], [16, 16]];
    comparison.protocol.regime_frames = 1;
    comparison.protocol.pictures = true;
    let (heard, results) = keep(&comparison, out, kept).unwrap();
    (heard.notes(), heard.steps(), results)
}

/// Runs that are kept are not among those that begin.
#[test]
fn a_sink_hears_of_the_runs_that_are_left() {
    let folder = tempfile::tempdir().unwrap();
    let progress = |methods: &[&str]| {
        let mut comparison = comparison(park(), methods, NOWHERE.as_ref(), &[8]);
        comparison.viewports = vec![[16, 16]];
        let (heard, _) = keep(&comparison, folder.path(), Kept::All).unwrap();
        heard.runs()
    };
    let one = "1 begin, one done, all end, ";
    assert_eq!(progress(&["nsm"]), one);
    assert_eq!(progress(&["nsm", "rt"]), one);
    assert_eq!(progress(&["nsm"]), "0 begin, all end, ");
}

#[test]
#[ignore = "a suite: `./test.sh --all` runs it"]
fn a_resumed_comparison_is_the_one_in_one_go() {
    let folder = tempfile::tempdir().unwrap();
    let (own, parts) = (folder.path().join("own"), folder.path().join("parts"));
    let both = |out: &Path, kept| compare(&["rt", "nsm"], &[8, 16], &own, out, kept);
    let (_, _, whole) = both(&folder.path().join("whole"), Kept::Others);
    let (_, _, begun) = compare(&["nsm"], &[16], &own, &parts, Kept::Others);
    let (text, _, resumed) = both(&parts, Kept::All);
    assert!(text.contains("2 of 6 runs are kept"), "{text}");
    assert_eq!(timeless(resumed.clone()), timeless(whole));
    assert_eq!(resumed["runs"][2], begun["runs"][0]);
    assert_eq!(resumed["runs"][5], begun["runs"][1]);

    // Nothing is left to do, so nothing is drawn.
    let (text, steps, again) = both(&parts, Kept::All);
    assert!(text.contains("6 of 6 runs are kept"), "{text}");
    assert_eq!(steps, [""; 0]);
    assert_eq!(again["runs"], resumed["runs"]);
    assert_eq!(timeless(again), timeless(resumed));

    // A shader that is not the same any more.
    let shader = sources(&own).read("shaders/shadow_lookup.wgsl").unwrap();
    fs::create_dir_all(own.join("shaders")).unwrap();
    let changed = [&shader.unwrap(), "// changed\n"].concat();
    fs::write(own.join("shaders/shadow_lookup.wgsl"), changed).unwrap();
    let (text, _, _) = both(&parts, Kept::All);
    assert!(
        text.contains("2 of 6 runs are kept") && text.contains("4 of the 6"),
        "{text}"
    );
}

#[test]
#[ignore = "a suite: `./test.sh --all` runs it"]
fn settings_stand_beside_each_other_and_runs_that_are_there_stay() {
    let out = tempfile::tempdir().unwrap();
    let keep = |words: &[&str], params: &[&str], kept| {
        let params: Vec<_> = params.iter().map(|set| set.parse().unwrap()).collect();
        let methods = load_methods(words, &params, &[8], &EmbeddedSources).unwrap();
        let mut comparison = Comparison::new(park(), methods).unwrap();
        comparison.views.truncate(1);
        comparison.viewports = vec![[16, 16]];
        comparison.protocol.pictures = true;
        let (heard, results) = keep(&timed(comparison, [0, 1, 1]), out.path(), kept).unwrap();
        let runs = results["runs"].as_array().unwrap().iter();
        let names = runs.map(|run| run["preset"].as_str().unwrap().to_owned());
        (heard.notes(), names.collect::<Vec<String>>())
    };
    keep(&["rt"], &[], Kept::Others);
    let words = ["crsm@n=1,depth=plane", "crsm"];
    let (text, names) = keep(&words, &["cull=front,none"], Kept::Others);
    assert!(
        text.contains("1 other run that") && text.contains("results.json holds already stays"),
        "{text}"
    );
    let own = ["n=1,depth=plane,cull=front", "n=1,depth=plane,cull=none"];
    let settings = own.into_iter().chain(["cull=front", "cull=none"]);
    let expected: Vec<String> = settings.map(|set| format!("crsm@{set}")).collect();
    assert_eq!(names, [&expected[..], &["rt".into()]].concat());
    let picture = "crsm-n-1-depth-plane-cull-none-bench_side-16x16-map8-error.png";
    assert!(out.path().join(picture).is_file());
    let (_, names) = keep(&["nsm"], &[], Kept::Nothing);
    assert_eq!(names, ["nsm"]);
}

#[test]
#[ignore = "a suite: `./test.sh --all` runs it"]
fn results_of_other_conditions_are_not_resumed() {
    let out = tempfile::tempdir().unwrap();
    let keep = |frames, kept| {
        let comparison = park_comparison(&["nsm"], NOWHERE.as_ref(), 8);
        keep(&timed(comparison, [0, frames, 0]), out.path(), kept)
    };
    let (heard, before) = keep(1, Kept::All).unwrap();
    let text = heard.notes();
    assert!(text.contains("results.json is not there yet"), "{text}");
    for kept in [Kept::All, Kept::Others] {
        let Err(error) = keep(2, kept) else {
            panic!("results of other conditions stay");
        };
        let text = error.to_string();
        assert!(text.contains("frames: there 1, here 2"), "{text}");
        let now = fs::read_to_string(out.path().join("results.json")).unwrap();
        assert_eq!(serde_json::from_str::<Value>(&now).unwrap(), before);
    }
    let (_, replaced) = keep(2, Kept::Nothing).unwrap();
    assert_eq!(replaced["frames"], 2);
}

#[test]
fn what_could_not_run_is_tried_again() {
    let folder = tempfile::tempdir().unwrap();
    // One is for Windows, one for Android: no adapter has both.
    let nowhere = LIT.replace(
        "format: 3,",
        r#"format: 3, requires: [
            "VULKAN_EXTERNAL_MEMORY_WIN32",
            "VULKAN_GOOGLE_DISPLAY_TIMING",
        ],"#,
    );
    fs::write(folder.path().join("nowhere.ron"), nowhere).unwrap();
    let keep = || {
        let comparison = park_comparison(&["nsm", "nowhere.ron"], folder.path(), 8);
        keep(&comparison, folder.path(), Kept::All).unwrap()
    };
    let (_, before) = keep();
    let run = &before["runs"][1];
    assert!(run["unavailable"].is_string(), "{run}");
    let (heard, again) = keep();
    let text = heard.notes();
    assert!(text.contains("1 of 2 runs are kept"), "{text}");
    assert_eq!(heard.steps(), [""; 0], "nothing is drawn");
    assert_eq!(again["runs"], before["runs"]);
    assert_eq!(timeless(again), timeless(before));
}
