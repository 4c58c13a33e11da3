//! `skiagraph stress` from outside. All but the first tests need an adapter; a machine without one
//! fails here with the program's own advice.

use serde_json::Value;
use skiagraph_cases::cases;
use std::{
    fs,
    path::Path,
    process::{Command, Output, Stdio},
};

/// A graph that lights everything and is sure of it.
const LIT: &str = include_str!("support/lit.ron");

fn stress(folder: &Path, line: &str) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_skiagraph"));
    command
        .arg("stress")
        .args(line.split_whitespace())
        .current_dir(folder)
        .env("NO_COLOR", "1");
    command
}

/// Returns what it printed on standard output and standard error, once it has ended with `code`.
#[track_caller]
fn ends(output: Output, code: i32) -> (String, String) {
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    let texts = (text(&output.stdout), text(&output.stderr));
    assert_eq!(
        output.status.code(),
        Some(code),
        "\nstdout:\n{}\nstderr:\n{}",
        texts.0,
        texts.1
    );
    texts
}

#[track_caller]
fn run(folder: &Path, line: &str, code: i32) -> (String, String) {
    let output = stress(folder, line).output();
    ends(output.expect("the program was built for this test"), code)
}

fn without_gpu(mut command: Command) -> Output {
    command
        .env("VK_ICD_FILENAMES", "/nonexistent")
        .env("VK_DRIVER_FILES", "/nonexistent")
        .output()
        .expect("the program was built for this test")
}

#[test]
fn the_list_needs_no_gpu_and_has_every_case() {
    let folder = tempfile::tempdir().unwrap();
    let (text, _) = ends(without_gpu(stress(folder.path(), "--list")), 0);
    // A reason goes on in the lines below, which begin with spaces.
    let mut rows: Vec<String> = Vec::new();
    for line in text.lines() {
        assert!(line.chars().count() <= 80, "{line}");
        let words = line.split_whitespace().collect::<Vec<_>>().join(" ");
        match rows.last_mut() {
            Some(row) if line.starts_with(' ') => *row += &format!(" {words}"),
            _ => rows.push(words),
        }
    }
    for case in cases() {
        let is_listed = |row: &String| {
            row.starts_with(&format!("{} ", case.name)) && row.ends_with(case.reason)
        };
        assert!(rows.iter().any(is_listed), "{} in\n{text}", case.name);
    }
    let (_, text) = ends(without_gpu(stress(folder.path(), "rt")), 3);
    assert!(text.contains("mesa-vulkan-drivers"), "{text}");
}

#[test]
fn an_unknown_case_or_method_is_named_before_anything_runs() {
    let folder = tempfile::tempdir().unwrap();
    for (line, code, part) in [
        ("--case box_on_flor", 1, "did you mean `box_on_floor`?"),
        ("--case zzzzzzzz", 1, "`skiagraph stress --list` names them"),
        ("nms", 1, "did you mean `nsm`?"),
        ("rt nsm --exact nms", 2, "did you mean `nsm`?"),
        ("rt --set cull=none", 1, "unknown param `cull`"),
        ("--size 0x1", 2, "at least 1x1"),
        ("--list rt", 2, "--list"),
    ] {
        let (_, text) = ends(without_gpu(stress(folder.path(), line)), code);
        assert!(text.contains(part), "{line}: {text}");
    }
}

#[test]
fn a_broken_guarantee_turns_its_cell_red() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("all_lit.ron"), LIT).unwrap();
    let line = "rt all_lit.ron --case box_on_floor --size 32x32";
    let (text, _) = run(folder.path(), line, 0);
    let marks = |text: &str| text.matches('✗').count();
    assert_eq!(marks(&text), 1, "only the legend's: {text}");
    let (text, errors) = run(folder.path(), &format!("{line} --exact all_lit.ron"), 1);
    assert!(errors.contains("error: 1 cell failed"), "{errors}");
    let look = "skiagraph stress all_lit.ron --case box_on_floor --size 32x32 --exact all_lit.ron \
        --save pictures";
    assert_eq!(marks(&text), 2, "{text}");
    for part in ["all_lit.ron on box_on_floor: ", look] {
        assert!(text.contains(part), "no {part:?} in\n{text}");
    }
    // The command is one that runs.
    let look = look.strip_prefix("skiagraph stress ").unwrap();
    run(folder.path(), look, 1);
    assert!(
        folder
            .path()
            .join("pictures/all_lit-box_on_floor-32x32-error.png")
            .is_file()
    );
}

#[test]
fn what_this_adapter_cannot_run_is_said_once() {
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
    let (text, _) = run(
        folder.path(),
        "rt nowhere.ron --case box_on_floor --size 8x8",
        0,
    );
    assert_eq!(
        text.matches("nowhere.ron is unavailable").count(),
        1,
        "{text}"
    );
    let (heads, _) = text.split_once("──").expect("the matrix has heads");
    assert!(
        heads.contains(" rt\n") && !heads.contains("nowhere.ron"),
        "{text}"
    );
    let (_, errors) = run(folder.path(), "nowhere.ron --size 8x8", 1);
    assert!(
        errors.contains("cannot run without the feature"),
        "{errors}"
    );
}

/// Ctrl-C after the first case: the cases that are done stay.
#[cfg(unix)]
#[test]
fn an_interrupt_keeps_the_cases_that_are_done() {
    let folder = tempfile::tempdir().unwrap();
    let mut child = stress(folder.path(), "rt nsm --size 256x256 --out .")
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let file = folder.path().join("stress.json");
    while !file.exists() {
        assert!(
            child.try_wait().unwrap().is_none(),
            "it ended before its first case"
        );
        std::thread::yield_now();
    }
    let sent = Command::new("kill")
        .args(["-INT", &child.id().to_string()])
        .status();
    assert!(sent.unwrap().success());
    let (_, errors) = ends(child.wait_with_output().unwrap(), 130);
    let total = cases().len();
    assert!(
        errors.contains(&format!("of {total} cases are kept in ./stress.json")),
        "{errors}"
    );
    let report: Value = serde_json::from_str(&fs::read_to_string(file).unwrap()).unwrap();
    let done = report["cases"].as_array().unwrap().len();
    assert!(errors.contains(&format!("{done} of {total}")), "{errors}");
}
