//! Methods that cannot run beside others that can: rows without figures, and an exit code.

use crate::support::skiagraph;
use std::{fs, path::Path};
use tempfile::TempDir;

const LIT: &str = include_str!("support/lit.ron");

/// Returns standard output and standard error of the program; its exit code is as expected.
#[track_caller]
fn printed(folder: &Path, line: &str, code: i32) -> [String; 2] {
    let output = skiagraph(folder, line);
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    let texts = [text(&output.stdout), text(&output.stderr)];
    assert_eq!(
        output.status.code(),
        Some(code),
        "{line}\n{}{}",
        texts[0],
        texts[1]
    );
    texts
}

/// A folder with the document `lit.ron`, and `typo.ron`, which has a mistake.
fn folder() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
    write("lit.ron", LIT);
    write(
        "typo.ron",
        &LIT.replace("target: \"status\"", "target: \"satus\""),
    );
    folder
}

const SMALL: &str = "--frames 1 --warmup 0 --size 16x16";

/// True if the table has a row of this method without figures.
fn is_without_figures(table: &str, method: &str) -> bool {
    let mut rows = table.lines().filter(|line| line.starts_with(method));
    rows.any(|row| row.contains("n/a"))
}

#[test]
fn a_document_with_a_mistake_loses_no_other_row_and_ends_with_exit_code_1() {
    let folder = folder();
    let line = format!("compare lit.ron typo.ron rt@engine=embree {SMALL} --images none --out out");
    let [table, told] = printed(folder.path(), &line, 1);
    assert!(is_without_figures(&table, "typo.ron"), "{table}");
    assert!(is_without_figures(&table, "rt@engine=embree"), "{table}");
    assert!(table.contains("`lit.ron` is the least wrong"), "{table}");
    assert!(told.contains("typo.ron:"), "the place: {told}");
    let end = told.lines().last().unwrap();
    assert!(
        end.starts_with("error: `typo.ron` cannot run: ") && end.contains("satus"),
        "{end}"
    );
    // Without it all is fine, whatever else cannot run here.
    printed(
        folder.path(),
        &line
            .replace("typo.ron ", "")
            .replace("--out out", "--out other"),
        0,
    );

    let line = format!("profile lit.ron typo.ron {SMALL}");
    let [table, told] = printed(folder.path(), &line, 1);
    assert!(table.contains("whole frame"), "{table}");
    assert!(
        table.contains("n/a: typo.ron, ") && told.contains("satus"),
        "{table}{told}"
    );

    let line = "stress lit.ron typo.ron rt@engine=embree --case torus --size 16x16";
    let [table, told] = printed(folder.path(), line, 1);
    assert!(
        table.contains("lit.ron") && table.contains("typo.ron"),
        "{table}"
    );
    let end = told.lines().last().unwrap();
    assert!(end.starts_with("error: `typo.ron` cannot run: "), "{told}");
    assert!(!told.contains("`rt@engine=embree` cannot run"), "{told}");

    for command in ["compare", "profile", "stress"] {
        let size = if command == "stress" {
            "--case torus"
        } else {
            SMALL
        };
        let [_, told] = printed(folder.path(), &format!("{command} typo.ron {size}"), 1);
        assert!(told.contains("satus"), "{command}: {told}");
        let [_, told] = printed(folder.path(), &format!("{command} lit.ron nms {size}"), 1);
        assert!(told.contains("did you mean `nsm`?"), "{command}: {told}");
    }
}

/// A scene on which no method can run takes nothing from the others.
#[test]
fn a_scene_without_a_method_loses_no_other_scene() {
    let folder = folder();
    let scene = |light: &str| {
        format!(
            r#"(format: 1, name: "s", mesh: Generated("park"), lights: [{light}],
            views: [(name: "bench", eye: (-23, 18, 30), direction: (0.4, -0.6, -0.7),
                fov_y_degrees: 60, near: 1, far: 400)])"#
        )
    };
    let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
    write(
        "night.ron",
        &scene(r#"Point(name: "bulb", position: (-14, 6, 4))"#),
    );
    write(
        "day.ron",
        &scene(r#"Directional(name: "sun", direction: (0.744, -0.408, 0.527))"#),
    );
    let line = format!(
        "compare esm --map-size 64 --scene night.ron --scene day.ron {SMALL} --images none --out \
         out"
    );
    let [table, told] = printed(folder.path(), &line, 1);
    assert!(
        table.contains("`pipelines/esm.ron` takes no point light"),
        "{table}"
    );
    assert!(told.contains("no method can run on night"), "{told}");
    let day = fs::read_to_string(folder.path().join("out/day/results.json")).unwrap();
    assert!(day.contains("\"wrong\""), "{day}");
    let [_, told] = printed(
        folder.path(),
        &line
            .replace("--scene day.ron", "")
            .replace("--out out", "--out one"),
        1,
    );
    assert!(told.contains("takes no point light"), "{told}");
}

/// Pictures whose names differ in capitals alone are one file on some systems.
#[test]
fn views_that_differ_in_capitals_alone_keep_their_pictures() {
    let folder = folder();
    let view = |name: &str| {
        format!(
            r#"(name: "{name}", eye: (-23, 18, 30), direction: (0.4, -0.6, -0.7),
                fov_y_degrees: 60, near: 1, far: 400),"#
        )
    };
    let text = format!(
        r#"(format: 1, name: "s", mesh: Generated("park"), light: (direction: (0.7, -0.4, 0.5)),
        views: [{}{}])"#,
        view("Main"),
        view("main")
    );
    fs::write(folder.path().join("two.ron"), text).unwrap();
    let line = format!("compare lit.ron --scene two.ron {SMALL} --out out");
    let [_, told] = printed(folder.path(), &format!("{line} --view all"), 1);
    assert!(told.contains("`Main`") && told.contains("`main`"), "{told}");
    assert!(told.contains("or differ only in capitals"), "{told}");
    let [table, _] = printed(
        folder.path(),
        &format!("{line} --view all --images none"),
        0,
    );
    assert!(table.contains("2 views"), "{table}");
    printed(folder.path(), &format!("{line} --view main"), 0);
}

#[test]
fn a_budget_of_no_memory_is_refused() {
    let folder = folder();
    for option in [
        "--memory 0",
        "--memory 0GiB",
        "--memory-limit 0",
        "--memory-limit -1",
    ] {
        let [_, told] = printed(folder.path(), &format!("compare lit.ron {option}"), 2);
        assert!(
            told.contains("a number of bytes above 0") || told.contains("unexpected"),
            "{told}"
        );
    }
}
