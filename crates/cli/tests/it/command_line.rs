//! The program from outside: exit codes, messages, files.

use std::{
    ffi::OsStr,
    fs,
    path::Path,
    process::{Command, Output},
};

/// Runs the program in `folder`, where nothing on disk stands before what is built in.
fn skiagraph<A: AsRef<OsStr>>(folder: &Path, arguments: &[A]) -> Output {
    program(folder, arguments)
        .output()
        .expect("the program was built for this test")
}

fn program<A: AsRef<OsStr>>(folder: &Path, arguments: &[A]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_skiagraph"));
    command
        .args(arguments)
        .current_dir(folder)
        .env("NO_COLOR", "1");
    command
}

fn stdout(output: &Output) -> String {
    String::from_utf8_lossy(&output.stdout).into_owned()
}

fn stderr(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

#[track_caller]
fn assert_exit(output: &Output, code: i32) {
    let status = output.status.code();
    assert_eq!(
        status,
        Some(code),
        "\nstdout:\n{}\nstderr:\n{}",
        stdout(output),
        stderr(output)
    );
}

/// A graph that clears two textures and calls them a shadow method.
const CLEARED: &str = include_str!("support/lit.ron");

#[test]
fn check_needs_no_gpu_and_shows_the_faults_of_all_files() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("good.ron"), CLEARED).unwrap();
    fs::write(
        folder.path().join("target.ron"),
        CLEARED.replace("target: \"status\"", "target: \"satus\""),
    )
    .unwrap();
    fs::write(
        folder.path().join("field.ron"),
        CLEARED.replace("value:", "valeu:"),
    )
    .unwrap();
    let output = program(
        folder.path(),
        &["check", "good.ron", "target.ron", "field.ron"],
    )
    .env("VK_ICD_FILENAMES", "/nonexistent")
    .env("VK_DRIVER_FILES", "/nonexistent")
    .output()
    .unwrap();
    assert_exit(&output, 1);
    assert!(
        stdout(&output).contains("good.ron: fine"),
        "{}",
        stdout(&output)
    );
    let faults = stderr(&output);
    for part in [
        "target.ron:",
        "`satus`",
        "field.ron:",
        "valeu",
        "in 2 graphs",
    ] {
        assert!(faults.contains(part), "no {part:?} in\n{faults}");
    }
    let line = ["check", "field.ron", "good.ron", "nms", "--format", "json"];
    let output = skiagraph(folder.path(), &line);
    assert_exit(&output, 1);
    let report: serde_json::Value = serde_json::from_str(&stdout(&output)).unwrap();
    let names = [0, 1, 2].map(|index| &report["files"][index]["file"]);
    assert_eq!(names, ["field.ron", "good.ron", "nms"]);
}

#[test]
fn the_reference_of_the_language_is_that_of_its_types() {
    let page = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/reference.md");
    let output = skiagraph(Path::new("."), &["schema", "--format", "markdown"]);
    let same = fs::read(page).unwrap() == output.stdout;
    assert!(
        same,
        "skiagraph schema --format markdown > docs/reference.md"
    );
    let output = skiagraph(Path::new("."), &["schema"]);
    let schema: serde_json::Value = serde_json::from_str(&stdout(&output)).unwrap();
    assert_eq!(
        schema,
        skiagraph_graph::schema(&skiagraph_passes::registry())
    );
}

#[test]
fn graph_draws_without_a_gpu_and_writes_whole_files() {
    let folder = tempfile::tempdir().unwrap();
    let draw = |arguments: &[&str]| {
        program(folder.path(), arguments)
            .env("VK_ICD_FILENAMES", "/nonexistent")
            .env("VK_DRIVER_FILES", "/nonexistent")
            .output()
            .unwrap()
    };
    let svg = draw(&["graph", "nsm", "--map-size", "4096", "--size", "640x480"]);
    assert_exit(&svg, 0);
    let text = stdout(&svg);
    assert!(text.starts_with("<svg ") && text.trim_end().ends_with("</svg>"));
    for part in ["nsm, viewport 640x480", "Depth32Float 4096×4096, 64.0 MiB"] {
        assert!(text.contains(part), "no {part:?} in\n{text}");
    }

    let dot = draw(&["graph", "rt", "--format", "dot"]);
    assert_exit(&dot, 0);
    assert!(stdout(&dot).starts_with("digraph "), "{}", stdout(&dot));

    // The ending of the file says what is wanted.
    let json = draw(&["graph", "rt", "--outputs", "ray_count", "--out", "rt.json"]);
    assert_exit(&json, 0);
    assert_eq!(stdout(&json), "");
    let text = fs::read_to_string(folder.path().join("rt.json")).unwrap();
    let drawing: serde_json::Value = serde_json::from_str(&text).unwrap();
    let culled: Vec<&str> = drawing["passes"]
        .as_array()
        .unwrap()
        .iter()
        .filter(|pass| !pass["culled"].is_null())
        .filter_map(|pass| pass["name"].as_str())
        .collect();
    assert_eq!(
        culled,
        [
            "gbuffer.visibility_buffer.shading_normal",
            "gbuffer.surface",
            "turn[0].fill_rays.dispatch_arguments",
            "turn[0].write_rays",
            "turn[0].trace_rays",
            "turn[0].fix_pixels"
        ]
    );
}

#[test]
fn graph_names_what_is_wrong() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(
        folder.path().join("target.ron"),
        CLEARED.replace("target: \"status\"", "target: \"satus\""),
    )
    .unwrap();
    for (arguments, part) in [
        (&["graph", "target.ron"][..], "`satus`"),
        (&["graph", "rt", "--outputs", "visibilty"], "`visibility`"),
        (&["graph", "rt", "--set", "bias=1"], "unknown param"),
        (&["graph", "rt", "--out", "missing/rt.svg"], "rt.svg"),
        (&["graph", "rtt"], "unknown preset `rtt`"),
    ] {
        let output = skiagraph(folder.path(), arguments);
        assert_exit(&output, 1);
        assert_eq!(stdout(&output), "");
        let faults = stderr(&output);
        assert!(faults.contains(part), "no {part:?} in\n{faults}");
    }
}

#[test]
fn show_writes_out_what_a_document_extends_with_its_origins() {
    let folder = tempfile::tempdir().unwrap();
    let show = |arguments: &[&str], code| {
        let output = skiagraph(folder.path(), arguments);
        assert_exit(&output, code);
        stdout(&output) + &stderr(&output)
    };
    let own = show(&["show", "crsma_full"], 0);
    assert!(own.contains("extends: \"crsm.ron\""), "{own}");
    // Behind it, as comments, what runs.
    for part in [
        "//   detect_uncertain\n//     reads camera, inner, light, map_fits, outer, primitive",
        "\n//     writes status, visibility\n",
        "\n// caster_turns = 1\n",
    ] {
        assert!(own.contains(part), "no {part} in {own}");
    }
    let flat = show(&["show", "crsma_full", "--flat"], 0);
    let inner = flat
        .lines()
        .find(|line| line.contains("name: \"inner\", shader:"))
        .unwrap();
    for part in [
        "inner_one_ring",
        "pipelines/crsm.ron:",
        "pipelines/crsma_full.ron:",
    ] {
        assert!(inner.contains(part), "{inner}");
    }
    // It reads as the document does, wherever its files are found.
    fs::create_dir(folder.path().join("pipelines")).unwrap();
    fs::write(folder.path().join("pipelines/flat.ron"), flat).unwrap();
    let passes = |name| show(&["graph", name, "--format", "json"], 0).replace(name, "");
    let drawn = |name| {
        let mut drawn: serde_json::Value = serde_json::from_str(&passes(name)).unwrap();
        for pass in drawn["passes"].as_array_mut().unwrap() {
            pass["file"] = ().into();
            pass["line"] = ().into();
        }
        drawn
    };
    assert_eq!(drawn("flat"), drawn("crsma_full"));
    let shader = show(&["show", "shared/light.wgsl"], 0);
    assert!(shader.contains("struct Light"), "{shader}");
    assert!(show(&["show", "shadow_lookup", "--flat"], 2).contains("is a shader"));
    assert!(show(&["show", "shadow_lokup"], 1).contains("did you mean `shadow_lookup"));
    assert!(own.contains("where adapter.software = false, adapter.subgroup_size = 0, "));
    assert!(show(&["show", "park"], 0).contains("name: \"park\""));
    assert!(show(&["show", "avenu"], 1).contains("did you mean `avenue`"));
    assert!(show(&["show", "park", "--flat"], 2).contains("is a scene file"));
}

#[test]
fn wrong_usage_has_exit_code_2() {
    let folder = tempfile::tempdir().unwrap();
    for line in [
        "",
        "frobnicate",
        "compare --size big",
        "run rt --save visibility=shadow.jpg",
        "run rt --view all --save visibility=shadow.png",
        "check",
        "compare --size 10",
        "compare --frames 0",
        "compare --frames 100001",
        "compare --warmup 4294967295 --frames 1",
        "run",
        "run rt --save visibility=a.gif",
        "compare --look 0,0,0",
        "compare --oracle offset:-1",
        "compare --oracle embree",
        "compare --under 3",
        "compare --below 200%",
        "compare --fail-if wrong>1%",
        "profile",
        "profile nsm --frames 0",
        "check a.ron --format yaml",
        "chart",
        "merge --out all",
        "merge park",
        "completions cmd",
        "chart out --kind pie",
        "doctor --memory-limit lots",
        "doctor --timeout -1",
        "doctor --timeout 86401",
        "compare --cells cells.jsonl --frames 3",
        "compare --cells cells.jsonl --shard 0/3",
        "compare --shard 1/3",
        "compare --plan cells.jsonl --resume",
        "compare --plan cells.jsonl --tune",
    ] {
        let words: Vec<&str> = line.split_whitespace().collect();
        assert_exit(&skiagraph(folder.path(), &words), 2);
    }
}

#[test]
fn wrong_input_has_exit_code_1_and_says_what_there_is() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(
        folder.path().join("other.ron"),
        CLEARED.replace("outputs: [\"visibility\", ", "outputs: ["),
    )
    .unwrap();
    let faults = [
        (&["compare", "other.ron"][..], "no output `visibility`"),
        (&["compare", "rt", "--set", "map_sise=4"], "unknown param"),
        (
            &["compare", "nsm", "--set", "map_sise=4"],
            "did you mean `map_size`?",
        ),
        (&["compare", "nsm", "--map-size", "many"], "invalid value"),
        (&["compare", "crsn"], "unknown preset `crsn`"),
        (&["compare", "--beside", "D:nowhere.csv"], "nowhere.csv"),
        (&["compare", "--beside", "D:other.ron"], "other.ron:1:1"),
    ];
    for (line, part) in faults {
        let output = skiagraph(folder.path(), line);
        assert!(
            stderr(&output).contains(part),
            "{line:?}\n{}",
            stderr(&output)
        );
        assert!(matches!(output.status.code(), Some(1 | 2)), "{line:?}");
    }
}

#[test]
fn without_an_adapter_every_gpu_command_ends_with_3_and_the_way_out() {
    let folder = tempfile::tempdir().unwrap();
    for line in [&["compare", "rt"][..], &["run", "rt"], &["doctor"]] {
        let output = program(folder.path(), line)
            .env("VK_ICD_FILENAMES", "/nonexistent")
            .env("VK_DRIVER_FILES", "/nonexistent")
            .output()
            .unwrap();
        assert_exit(&output, 3);
        assert!(
            stderr(&output).contains("mesa-vulkan-drivers"),
            "{line:?}: {}",
            stderr(&output)
        );
    }
}

#[test]
fn files_that_would_overwrite_each_other_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let save = "run nsm --save visibility=x.png --save status=./x.png";
    let save: Vec<&str> = save.split(' ').collect();
    let output = skiagraph(folder.path(), &save);
    assert_exit(&output, 2);
    let text = stderr(&output);
    assert!(
        text.contains("visibility") && text.contains("status") && text.contains("x.png"),
        "{text}"
    );
}

#[test]
fn lists_are_printed_and_a_closed_pipe_is_no_failure() {
    let folder = tempfile::tempdir().unwrap();
    let presets = skiagraph(folder.path(), &["presets"]);
    assert_exit(&presets, 0);
    assert!(
        stdout(&presets).contains("--set map_size=1024"),
        "{}",
        stdout(&presets)
    );
    let scenes = skiagraph(folder.path(), &["scenes"]);
    assert_exit(&scenes, 0);
    assert!(stdout(&scenes).contains("park") && stdout(&scenes).contains("sponza"));

    let mut child = program(folder.path(), &["presets"])
        .stdout(std::process::Stdio::piped())
        .spawn()
        .unwrap();
    drop(child.stdout.take());
    assert_eq!(child.wait().unwrap().code(), Some(0));
}

#[test]
fn a_scene_or_view_that_is_not_there_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let scene = skiagraph(folder.path(), &["run", "rt", "--scene", "prak"]);
    assert_exit(&scene, 1);
    assert!(
        stderr(&scene).contains("did you mean `park`?"),
        "{}",
        stderr(&scene)
    );
    let view = skiagraph(folder.path(), &["run", "rt", "--view", "bench_sid"]);
    assert_exit(&view, 1);
    assert!(
        stderr(&view).contains("did you mean `bench_side`?"),
        "{}",
        stderr(&view)
    );
    let own = skiagraph(folder.path(), &["run", "rt", "--near", "9", "--far", "5"]);
    assert_exit(&own, 2);
    assert!(
        stderr(&own).contains("near is 9 and far is 5"),
        "{}",
        stderr(&own)
    );
}

/// The results that a unit test pins, as `compare` would have kept them.
fn kept(folder: &Path, change: impl FnOnce(&mut serde_json::Value)) {
    let pinned = include_str!(
        "../../../compare/src/records/snapshots/\
         skiagraph_compare__records__results__tests__the_schema_is_pinned_and_reads_back.snap"
    );
    let (_, text) = pinned.split_once("\n---\n").unwrap();
    let mut results = serde_json::from_str(text).unwrap();
    change(&mut results);
    fs::create_dir_all(folder).unwrap();
    fs::write(folder.join("results.json"), results.to_string()).unwrap();
}

#[test]
fn chart_draws_kept_results_without_a_gpu() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let without_gpu_times = 1;
    for (name, triangles) in [("small", 10_000), ("large", 1_000_000)] {
        kept(&folder.join(name), |results| {
            results["runs"]
                .as_array_mut()
                .unwrap()
                .remove(without_gpu_times);
            results["scene"]["triangles"] = triangles.into();
        });
    }
    let output = skiagraph(folder, &["chart", "small"]);
    assert_exit(&output, 0);
    assert!(stdout(&output).starts_with("<svg") && stdout(&output).contains("map 1024²"));
    assert!(stderr(&output).contains("not drawn: rt_hw: needs ray queries"));
    let growth = [
        "chart",
        "large",
        "small",
        "--kind",
        "growth",
        "--out",
        "growth.svg",
    ];
    let output = skiagraph(folder, &growth);
    assert_exit(&output, 0);
    assert_eq!(stdout(&output), "");
    let svg = fs::read_to_string(folder.join("growth.svg")).unwrap();
    assert!(
        svg.contains("park, view main, 512x256") && svg.contains("10⁵"),
        "{svg}"
    );
    // The same chart in pixels, two for each of its units, with words in it: dark on white.
    let output = skiagraph(folder, &["chart", "small", "--out", "front.png"]);
    assert_exit(&output, 0);
    let output = skiagraph(folder, &["chart", "small", "--out", "front.svg"]);
    assert_exit(&output, 0);
    let svg = fs::read_to_string(folder.join("front.svg")).unwrap();
    let picture = image::open(folder.join("front.png")).unwrap().to_rgb8();
    let [width, height] = [picture.width(), picture.height()].map(|side| side / 2);
    assert!(svg.starts_with(&format!("<svg width=\"{width}\" height=\"{height}\"")));
    let title = picture
        .enumerate_pixels()
        .filter(|(_, y, _)| *y < height / 5);
    let dark = title
        .filter(|(.., pixel)| pixel.0.iter().all(|&it| it < 100))
        .count();
    assert!(dark > 200, "{dark}");
}

#[test]
fn chart_says_what_is_missing() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    fs::create_dir(folder.join("empty")).unwrap();
    fs::create_dir(folder.join("foreign")).unwrap();
    fs::write(folder.join("foreign/results.json"), "{\"a\": 1}").unwrap();
    kept(&folder.join("timeless"), |_| {});
    kept(&folder.join("good"), |results| {
        results["runs"].as_array_mut().unwrap().truncate(1);
    });
    let refused = |arguments: &[&str]| {
        let output = skiagraph(folder, &[&["chart"], arguments].concat());
        assert_exit(&output, 1);
        assert_eq!(stdout(&output), "");
        stderr(&output)
    };
    for (arguments, message) in [
        (
            &["good", "nowhere"][..],
            "there is no folder nowhere; name a folder that",
        ),
        (
            &["empty"],
            "there is no results.json in empty; name a folder that",
        ),
        (&["foreign"], "`foreign/results.json` is not a results.json"),
        (&["timeless"], "timeless: there are no GPU times to draw"),
        (
            &["good", "--size", "1x1"],
            "there is nothing to draw: no run of 1x1 has measurements",
        ),
        (
            &["good", "--out", "nowhere/a.svg"],
            "there is no folder nowhere",
        ),
    ] {
        let error = refused(arguments);
        assert!(error.contains(message), "{arguments:?}: {error}");
    }
    let usage = ["chart", "good", "--kind", "growth", "--error", "rmse"];
    let output = skiagraph(folder, &usage);
    assert_exit(&output, 2);
    let message = "--error: a chart of growth draws no error";
    assert!(stderr(&output).contains(message), "{}", stderr(&output));
}

#[test]
fn a_document_is_planned_under_the_lights_that_it_takes() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    assert_exit(&skiagraph(folder, &["new", "mine"]), 0);
    let document = fs::read_to_string(folder.join("mine.ron")).unwrap();
    let field = "lights: [directional, spot, point]";
    assert!(document.contains(field), "{document}");
    fs::create_dir(folder.join("pipelines")).unwrap();
    fs::copy(folder.join("mine.wgsl"), folder.join("pipelines/mine.wgsl")).unwrap();
    for (lights, refused) in [
        ("point", "takes no directional or spot light"),
        ("spot, point", "takes no directional light"),
    ] {
        let document = document.replace(field, &format!("lights: [{lights}]"));
        fs::write(folder.join("mine.ron"), &document).unwrap();
        let checked = skiagraph(folder, &["check", "mine.ron"]);
        assert_exit(&checked, 0);
        assert!(stdout(&checked).contains(refused), "{}", stdout(&checked));
        let drawn = skiagraph(folder, &["graph", "mine.ron", "--format", "json"]);
        assert_exit(&drawn, 0);
        assert!(stdout(&drawn).contains("\"light\""));
        // As a preset of the folder.
        fs::write(folder.join("pipelines/lamps_only.ron"), &document).unwrap();
        let listed = skiagraph(folder, &["presets", "--format", "markdown"]);
        assert_exit(&listed, 0);
        let row = stdout(&listed);
        let row = row.lines().find(|line| line.contains("`lamps_only`"));
        assert!(row.is_some_and(|row| row.contains(&format!("| {lights} |"))));
        // A mistake is shown, and no light that the document does not take.
        let broken = document.replace("outputs: [", "outputs: [\"nothing\", ");
        assert_ne!(broken, document);
        fs::write(folder.join("mine.ron"), broken).unwrap();
        let checked = skiagraph(folder, &["check", "mine.ron"]);
        assert_exit(&checked, 1);
        let errors = stderr(&checked);
        assert!(
            errors.contains("`nothing`") && !errors.contains("takes no"),
            "{errors}"
        );
    }
    let strange = document.replace(field, "lights: [sun]");
    fs::write(folder.join("mine.ron"), strange).unwrap();
    let checked = skiagraph(folder, &["check", "mine.ron"]);
    assert_exit(&checked, 1);
    assert!(stderr(&checked).contains("it takes: sun"));
}

/// A scene file is told of as a document is, with the lines that are wrong.
#[test]
fn a_broken_scene_file_is_shown_in_its_lines() {
    let folder = tempfile::tempdir().unwrap();
    let scene = "(\n    format: 1,\n    name: \"a\",\n    mesh: Genrated(\"park\"),\n)";
    fs::write(folder.path().join("a.ron"), scene).unwrap();
    let output = skiagraph(folder.path(), &["compare", "nsm", "--scene", "a.ron"]);
    assert_eq!(output.status.code(), Some(1));
    let errors = String::from_utf8_lossy(&output.stderr);
    for part in [
        "╭─[a.ron:4:11]",
        "4 │     mesh: Genrated(\"park\"),",
        "did you mean `Generated`?",
        "a scene needs at least one view",
        "cannot load the scene `a.ron`",
    ] {
        assert!(errors.contains(part), "{errors}");
    }
}
