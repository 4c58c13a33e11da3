//! Commands that write into one folder at once lose nothing of each other. Needs an adapter.

use crate::support::skiagraph;
use serde_json::Value;
use std::{
    fs::{self, File},
    path::Path,
    process::{Child, Command, Stdio},
};

fn begin(folder: &Path, line: &str) -> Child {
    Command::new(env!("CARGO_BIN_EXE_skiagraph"))
        .args(line.split_whitespace())
        .current_dir(folder)
        .env("NO_COLOR", "1")
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the program was built for this test")
}

#[test]
fn two_comparisons_into_one_folder_keep_the_runs_of_both() {
    let folder = tempfile::tempdir().unwrap();
    let rest = "--size 32x32 --map-size 32 --frames 2 --warmup 0 --out out";
    let lines = ["rt nsm", "nsm pcf"].map(|methods| format!("compare {methods} {rest}"));
    let both = lines.map(|line| begin(folder.path(), &line));
    for child in both {
        let output = child.wait_with_output().unwrap();
        let stderr = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success(), "{stderr}");
    }
    let out = folder.path().join("out");
    let text = fs::read_to_string(out.join("results.json")).unwrap();
    let results: Value = serde_json::from_str(&text).unwrap();
    let runs = results["runs"].as_array().unwrap();
    let mut names: Vec<&str> = runs
        .iter()
        .filter_map(|run| run["preset"].as_str())
        .collect();
    names.sort_unstable();
    assert_eq!(names, ["nsm", "pcf", "rt"]);
    assert_eq!(results["commands"].as_array().unwrap().len(), 2, "{text}");
    for run in runs {
        for picture in run["images"].as_object().unwrap().values() {
            let picture = out.join(picture.as_str().unwrap());
            assert!(picture.is_file(), "{}", picture.display());
        }
    }
    let csv = fs::read_to_string(out.join("results.csv")).unwrap();
    assert_eq!(csv.lines().count(), 4, "{csv}");
    let page = fs::read_to_string(out.join("report.html")).unwrap();
    for name in ["rt", "nsm 32", "pcf 32"] {
        assert!(page.contains(&format!("\"label\":\"{name}\"")), "{name}");
    }
}

#[test]
fn a_matrix_that_another_command_writes_is_not_overwritten() {
    let folder = tempfile::tempdir().unwrap();
    let line = "stress nsm --case box_on_floor --size 16x16 --map-size 16 --out out";
    fs::create_dir(folder.path().join("out")).unwrap();
    let lock = File::create(folder.path().join("out/.skiagraph-stress.lock")).unwrap();
    lock.lock().unwrap();
    let refused = skiagraph(folder.path(), line);
    let stderr = String::from_utf8_lossy(&refused.stderr);
    assert_eq!(refused.status.code(), Some(1), "{stderr}");
    assert!(stderr.contains("another `skiagraph stress`"), "{stderr}");
    assert!(!folder.path().join("out/stress.json").exists());
    drop(lock);
    assert_eq!(skiagraph(folder.path(), line).status.code(), Some(0));
    assert!(folder.path().join("out/stress.json").exists());
}
