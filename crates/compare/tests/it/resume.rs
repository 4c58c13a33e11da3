//! Results in a folder, and going on from those that are there.

use crate::support::{park, sources};
use serde_json::Value;
use skiagraph_compare::{
    comparison::Comparison,
    graphs::shadow_method::load_methods,
    measuring::{resume::Kept, series::Series},
    sink::{Session, Sink},
};
use skiagraph_graph::Sources;
use std::{fs, path::Path, sync::Mutex};

/// Results without times, and without the commands that measured them.
fn timeless(mut value: Value) -> Value {
    fn clear(value: &mut Value) {
        match value {
            Value::Object(fields) if fields.contains_key("p95") => *value = Value::Null,
            Value::Object(fields) => {
                fields.remove("date");
                fields.remove("commands");
                // The reason has times in it.
                fields.remove("gpu_unavailable");
                fields.values_mut().for_each(clear);
            }
            Value::Array(items) => items.iter_mut().for_each(clear),
            _ => {}
        }
    }
    clear(&mut value);
    value
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
    let mut comparison = comparison(park(), methods, own, map_sizes);
    comparison.viewports = vec![[24, 16], [16, 16]];
    comparison.protocol.cached_frames = 1;
    comparison.protocol.pictures = true;
    let (heard, results) = keep(&comparison, out, kept).unwrap();
    (heard.notes(), heard.steps(), results)
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
