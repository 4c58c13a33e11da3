//! The program run in a folder, and what it leaves there.

use serde_json::Value;
use std::{
    fs,
    path::Path,
    process::{Command, Output},
};

/// Runs the program with the words of a line.
pub fn skiagraph(folder: &Path, line: &str) -> Output {
    Command::new(env!("CARGO_BIN_EXE_skiagraph"))
        .args(line.split_whitespace())
        .current_dir(folder)
        .env("NO_COLOR", "1")
        .env("SKIAGRAPH_PROGRESS", "lines")
        .output()
        .expect("the program was built for this test")
}

/// The runs in `out` of a comparison that succeeds, and its table.
#[allow(dead_code, reason = "not every test compares")]
pub fn results(folder: &Path, line: &str) -> (Vec<Value>, String) {
    let output = skiagraph(folder, line);
    let stderr = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{line}: {stderr}");
    let text = fs::read_to_string(folder.join("out/results.json")).unwrap();
    let results: Value = serde_json::from_str(&text).unwrap();
    let table = String::from_utf8_lossy(&output.stdout).into_owned();
    (results["runs"].as_array().unwrap().clone(), table)
}
