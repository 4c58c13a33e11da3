//! Results in a folder, and going on from those that are there.

use crate::support::{park, sources};
use crate::timeless::timeless;
use serde_json::Value;
use skiagraph_compare::{
    comparison::Comparison,
    graphs::shadow_method::load_methods,
    measuring::{resume::Kept, series::Series},
    sink::{Session, Sink},
};
use skiagraph_graph::Sources;
use std::{fs, path::Path, sync::Mutex};

/// Keeps notes, and the names of steps that begin.
#[derive(Default)]
struct Heard {
    notes: Mutex<String>,
    steps: Mutex<Vec<String>>,
}

impl Sink for Heard {
    fn note(&self, text: &str) {
        *self.notes.lock().unwrap() += text;
    }

    fn begin_step(&self, name: &str, _total: u64, _unit: &'static str) {
        self.steps.lock().unwrap().push(name.to_owned());
    }
}

/// Compares methods, those of a folder first, and keeps the results in a folder; returns what was
/// heard, and the file.
fn compare(
    methods: &[&str],
    map_sizes: &[u32],
    own: &Path,
    out: &Path,
    kept: Kept,
) -> (String, Vec<String>, Value) {
    let methods = load_methods(methods, &[], map_sizes, &sources(own)).unwrap();
    let mut comparison = Comparison::new(park(), methods).unwrap();
    comparison.views.truncate(1);
    comparison.viewports = vec![[24, 16], [16, 16]];
    (comparison.protocol.frames, comparison.protocol.warmup) = (1, 0);
    (
        comparison.protocol.cached_frames,
        comparison.protocol.pictures,
    ) = (1, true);
    let heard = Heard::default();
    let session = Session::new(crate::support::gpu(), &heard);
    comparison.check(session).unwrap();
    fs::create_dir_all(out).unwrap();
    let mut series = Series::new(&comparison, session, Some((out, kept))).unwrap();
    for viewport in 0..comparison.viewports.len() {
        series.measure(0, viewport).unwrap();
    }
    series.save(&[]).unwrap();
    drop(series);
    let text = fs::read_to_string(out.join("results.json")).unwrap();
    let notes = heard.notes.into_inner().unwrap();
    let steps = heard.steps.into_inner().unwrap();
    (notes, steps, serde_json::from_str(&text).unwrap())
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
