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
    let [table, stderr] = printed(folder.path(), &line, 1);
    assert!(is_without_figures(&table, "typo.ron"), "{table}");
    assert!(is_without_figures(&table, "rt@engine=embree"), "{table}");
    assert!(table.contains("`lit.ron` is the least wrong"), "{table}");
    assert!(stderr.contains("typo.ron:"), "the place: {stderr}");
    let end = stderr.lines().last().unwrap();
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
    let [table, stderr] = printed(folder.path(), &line, 1);
    assert!(table.contains("whole frame"), "{table}");
    assert!(
        table.contains("n/a: typo.ron, ") && stderr.contains("satus"),
        "{table}{stderr}"
    );

    let line = "stress lit.ron typo.ron rt@engine=embree --case torus --size 16x16";
    let [table, stderr] = printed(folder.path(), line, 1);
    assert!(
        table.contains("lit.ron") && table.contains("typo.ron"),
        "{table}"
    );
    let end = stderr.lines().last().unwrap();
    assert!(
        end.starts_with("error: `typo.ron` cannot run: "),
        "{stderr}"
    );
    assert!(
        !stderr.contains("`rt@engine=embree` cannot run"),
        "{stderr}"
    );

    for command in ["compare", "profile", "stress"] {
        let size = if command == "stress" {
            "--case torus"
        } else {
            SMALL
        };
        let [_, stderr] = printed(folder.path(), &format!("{command} typo.ron {size}"), 1);
        assert!(stderr.contains("satus"), "{command}: {stderr}");
        let [_, stderr] = printed(folder.path(), &format!("{command} lit.ron nms {size}"), 1);
        assert!(
            stderr.contains("did you mean `nsm`?"),
            "{command}: {stderr}"
        );
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
    let [table, stderr] = printed(folder.path(), &line, 1);
    assert!(
        table.contains("`pipelines/esm.ron` takes no point light"),
        "{table}"
    );
    assert!(stderr.contains("no method can run on night"), "{stderr}");
    let day = fs::read_to_string(folder.path().join("out/day/results.json")).unwrap();
    assert!(day.contains("\"wrong\""), "{day}");
    let tuned = line.replace("--out out", "--tune --out tuned");
    let [_, stderr] = printed(folder.path(), &tuned, 1);
    assert!(stderr.contains("no method can run on night"), "{stderr}");
    let day = fs::read_to_string(folder.path().join("tuned/day/results.json")).unwrap();
    assert!(day.contains("\"wrong\""), "{day}");
    let planned = line.replace("--out out", "--plan plan.json");
    let [_, stderr] = printed(folder.path(), &planned, 0);
    assert!(stderr.contains("2 cells are in plan.json"), "{stderr}");
    let cells = "compare --cells plan.json --out shard";
    let [_, stderr] = printed(folder.path(), cells, 0);
    assert!(stderr.contains("2 cells are in shard"), "{stderr}");
    assert!(stderr.contains("map 64 cannot run here"), "{stderr}");
    write(
        "lamp.ron",
        &scene(
            r#"Spot(name: "lamp", position: (-10, 20, 8), direction: (-0.1, -1, 0.1),
                cone_degrees: 110)"#,
        ),
    );
    // Where all are refused, the reasons of all are told.
    let none = line.replace("day.ron", "lamp.ron");
    let [_, stderr] = printed(folder.path(), &none, 1);
    for light in ["spot", "point"] {
        assert!(
            stderr.contains(&format!("takes no {light} light")),
            "{stderr}"
        );
    }
    let [_, stderr] = printed(
        folder.path(),
        &line
            .replace("--scene day.ron", "")
            .replace("--out out", "--out one"),
        1,
    );
    assert!(stderr.contains("takes no point light"), "{stderr}");
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
    let [_, stderr] = printed(folder.path(), &format!("{line} --view all"), 1);
    assert!(
        stderr.contains("`Main`") && stderr.contains("`main`"),
        "{stderr}"
    );
    assert!(stderr.contains("or differ only in capitals"), "{stderr}");
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
    for option in ["--memory", "--memory-limit"] {
        for value in ["0", "0GiB"] {
            let line = format!("compare lit.ron {option} {value}");
            let [_, stderr] = printed(folder.path(), &line, 2);
            assert!(stderr.contains("a number of bytes above 0"), "{stderr}");
            assert!(stderr.contains(&format!("'{option} ")), "{stderr}");
        }
        let [_, stderr] = printed(folder.path(), &format!("compare lit.ron {option}=-1"), 2);
        assert!(stderr.contains("a number of bytes above 0"), "{stderr}");
        assert!(stderr.contains(&format!("'{option} ")), "{stderr}");
    }
}

/// A folder with `lit.ron` and a document that has other sections beside its own.
fn folder_with(name: &str, sections: &str) -> TempDir {
    let folder = folder();
    let text = LIT.replace("format: 3,", &format!("format: 3, {sections}"));
    fs::write(folder.path().join(name), text).unwrap();
    folder
}

/// A scene that a document excludes is no mistake of the document.
#[test]
fn a_document_that_needs_more_than_there_is_is_a_row_and_no_mistake() {
    let folder = folder_with("two.ron", r#"needs: ["lights.count >= 2"],"#);
    for command in ["compare", "stress"] {
        let rest = match command {
            "compare" => format!("{SMALL} --images none --out out"),
            _ => "--case torus --size 16x16".into(),
        };
        let line = format!("{command} lit.ron two.ron {rest}");
        let [table, stderr] = printed(folder.path(), &line, 0);
        assert!(
            table.contains("needs `lights.count >= 2`"),
            "{line}: {table}{stderr}"
        );
        assert!(!stderr.contains("cannot run"), "{line}: {stderr}");
    }
}

#[test]
fn a_mistake_is_told_whatever_was_refused_before_it() {
    let folder = folder();
    let spot = LIT.replace("format: 3,", "format: 3, lights: [spot],");
    let spot = spot.replacen("R8Uint)", "R8Uint, size: 5)", 1);
    fs::write(folder.path().join("spot.ron"), spot).unwrap();
    let line = "stress lit.ron spot.ron --case torus --case spot_inside_a_mesh --size 16x16";
    let [table, stderr] = printed(folder.path(), line, 1);
    assert!(table.contains("lit.ron"), "{table}");
    let end = stderr.lines().last().unwrap();
    assert!(
        end.starts_with("error: `spot.ron` cannot run: "),
        "{stderr}"
    );
    assert!(!end.contains("takes no"), "{stderr}");
}

/// The row has all other figures.
#[test]
fn a_mistake_in_an_output_that_describes_the_map_ends_with_exit_code_1() {
    let folder = folder();
    let text = LIT
        .replace(
            "materials: [",
            r#"materials: [Texture(name: "texel_density", format: R32Float, size: 5),"#,
        )
        .replace(
            "passes: [",
            r#"passes: [Clear(name: "no", target: "texel_density"),"#,
        )
        .replace(
            r#""status"],"#,
            r#""status", (name: "texel_density", on_request: true)],"#,
        );
    fs::write(folder.path().join("density.ron"), text).unwrap();
    let line = format!("compare lit.ron density.ron {SMALL} --images none --out out");
    let [table, stderr] = printed(folder.path(), &line, 1);
    assert!(!is_without_figures(&table, "density.ron"), "{table}");
    let end = stderr.lines().last().unwrap();
    assert!(
        end.starts_with("error: `density.ron`: ") && end.contains("texel_density"),
        "{stderr}"
    );
    let line = "stress lit.ron density.ron --case torus --size 16x16";
    let [_, stderr] = printed(folder.path(), line, 1);
    assert!(stderr.contains("texel_density"), "{stderr}");
}

#[test]
fn a_param_that_no_sound_document_has_is_refused() {
    let folder = folder();
    // Not even the params of this one are known.
    fs::write(folder.path().join("broken.ron"), "(format: 3, oops").unwrap();
    let line = format!("compare nsm broken.ron --set biass=1 {SMALL}");
    let [_, stderr] = printed(folder.path(), &line, 1);
    for part in [
        "unknown param `biass`",
        "`broken.ron`",
        "did you mean `bias`",
    ] {
        assert!(stderr.contains(part), "{stderr}");
    }
}
