//! Which surface each pixel shows: `compare` draws the right one however near the near plane is,
//! and says so where it does not.

use serde_json::Value;
use skiagraph_graph::Sources;
use skiagraph_passes::EmbeddedSources;
use std::{fs, path::Path, process::Command};

/// A floor of 8 × 8, and a flat box of 2 × 2 over it.
const BOX_OVER_FLOOR: &str = "\
    v -4 0 -4\nv 4 0 -4\nv 4 0 4\nv -4 0 4\n\
    v -1 1 -1\nv -1 1 1\nv -1 1.2 -1\nv -1 1.2 1\nv 1 1 -1\nv 1 1 1\nv 1 1.2 -1\nv 1 1.2 1\n\
    f 1 4 3 2\nf 5 6 8 7\nf 9 11 12 10\nf 5 9 10 6\nf 7 8 12 11\nf 5 7 11 9\nf 6 10 12 8\n";

/// Returns what the program prints, and the one run of results.json.
fn compared(folder: &Path, near: &str, out: &str) -> (String, Value) {
    fs::write(folder.join("box.obj"), BOX_OVER_FLOOR).unwrap();
    let line = format!(
        "compare rt --scene box.obj --eye 300,3000,10 --look -300,-3000,-10 --fov 0.2 \
         --near {near} --far 10000 --size 64x64 --frames 1 --warmup 0 --cached-frames 0 \
         --images none --out {out}"
    );
    let output = Command::new(env!("CARGO_BIN_EXE_skiagraph"))
        .args(line.split_whitespace())
        .current_dir(folder)
        .env("NO_COLOR", "1")
        .output()
        .unwrap();
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{line}: {text}\n{errors}");
    let results = fs::read(folder.join(out).join("results.json")).unwrap();
    let mut results: Value = serde_json::from_slice(&results).unwrap();
    (text, results["runs"][0].take())
}

#[test]
fn a_near_plane_however_near_leaves_the_picture_as_it_is() {
    let folder = tempfile::tempdir().unwrap();
    let (_, expected) = compared(folder.path(), "100", "far");
    assert!(expected["pixels"]["shadow"].as_u64().unwrap() > 50);
    for near in ["0.1", "1e-4", "1e-10"] {
        let (text, run) = compared(folder.path(), near, near);
        assert_eq!(run["pixels"], expected["pixels"], "near {near}");
        assert_eq!(run["wrong_surface"], 0, "near {near}");
        assert!(!text.contains("show a surface"), "{text}");
    }
}

#[test]
fn a_surface_that_another_one_hides_is_counted_and_said() {
    let folder = tempfile::tempdir().unwrap();
    let path = "pipelines/shared/gbuffer.ron";
    let text = EmbeddedSources.read(path).unwrap().unwrap();
    // The farthest surface instead of the nearest one.
    let farthest = text.replace("load: Clear(0), compare: Greater", "load: Clear(1)");
    assert_ne!(*farthest, *text);
    fs::create_dir_all(folder.path().join("pipelines/shared")).unwrap();
    fs::write(folder.path().join(path), farthest).unwrap();
    let (text, run) = compared(folder.path(), "100", "out");
    let count = run["wrong_surface"].as_u64().unwrap();
    // The box covers a sixteenth of the floor.
    assert!(count > 100, "{count}");
    let said = format!("warning: {count} of 4,096 pixels show a surface that another one hides");
    assert!(text.contains(&said), "{text}");
    let report = fs::read_to_string(folder.path().join("out/report.html")).unwrap();
    assert!(report.contains(&said));
    let csv = fs::read_to_string(folder.path().join("out/results.csv")).unwrap();
    assert!(csv.lines().next().unwrap().ends_with(",wrong_surface"));
    assert!(csv.lines().nth(1).unwrap().ends_with(&format!(",{count}")));
}
