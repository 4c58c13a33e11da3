//! `profile` from outside. What measures needs an adapter; a machine without one fails here with
//! the program's own advice.

use serde_json::Value;
use std::{
    collections::BTreeMap,
    fs,
    path::Path,
    process::{Command, Output, Stdio},
};

fn program(folder: &Path, line: &str) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_skiagraph"));
    command
        .args(line.split_whitespace())
        .current_dir(folder)
        .env("NO_COLOR", "1")
        .env("SKIAGRAPH_PROGRESS", "lines");
    command
}

#[track_caller]
fn skiagraph(folder: &Path, line: &str, code: i32) -> Output {
    let output = program(folder, line)
        .output()
        .expect("the program was built for this test");
    assert_eq!(
        output.status.code(),
        Some(code),
        "{line}\n{}\n{}",
        String::from_utf8_lossy(&output.stdout),
        String::from_utf8_lossy(&output.stderr)
    );
    output
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

fn json(path: &Path) -> Value {
    serde_json::from_slice(&fs::read(path).unwrap()).unwrap()
}

const NSM: &str = "profile nsm --size 32x24 --map-size 32 --frames 6 --warmup 1";
const PASSES: [&str; 5] = [
    "gbuffer.visibility_buffer.primitive",
    "gbuffer.surface",
    "create_shadow_map.fit_map.over_scene",
    "create_shadow_map.draw[0]",
    "shadow_lookup",
];

#[test]
fn a_profile_says_under_what_it_was_measured_and_writes_all_its_files() {
    let folder = tempfile::tempdir().unwrap();
    let line = format!("{NSM} --json p.json --csv p.csv --trace p.trace.json");
    let report = text(&skiagraph(folder.path(), &line, 0).stdout);
    let profile = json(&folder.path().join("p.json"));
    let adapter = &profile["conditions"]["adapter"];
    for part in [
        adapter["name"].as_str().unwrap(),
        adapter["driver"].as_str().unwrap(),
        adapter["backend"].as_str().unwrap(),
        profile["conditions"]["date"].as_str().unwrap(),
        "nsm on park, 54,876 triangles · view bench_side · 32x24",
        "map_size = 32",
        "6 frames after 1 to warm up",
        "GPU timestamps",
        concat!("skiagraph ", env!("CARGO_PKG_VERSION")),
        "shadow_map",
        "Depth32Float",
    ] {
        assert!(report.contains(part), "no {part:?} in\n{report}");
    }

    let names: Vec<_> = profile["passes"]
        .as_array()
        .unwrap()
        .iter()
        .map(|pass| pass["name"].as_str().unwrap())
        .collect();
    assert_eq!(names, PASSES);
    let is_trusted = adapter["gpu_unavailable"].is_null();
    for times in profile["passes"]
        .as_array()
        .unwrap()
        .iter()
        .chain([&profile["frame"]])
    {
        assert_eq!(times["gpu_ms"].is_object(), is_trusted, "{times}");
        let clocks = ["gpu_ms", "cpu_ms", "wall_ms"].map(|clock| &times[clock]);
        for series in clocks.into_iter().filter(|series| series.is_object()) {
            assert_eq!(series["samples"].as_array().unwrap().len(), 6);
            let [min, median, p95, max] =
                ["min", "median", "p95", "max"].map(|key| series[key].as_f64().unwrap());
            assert!(
                0.0 <= min && min <= median && median <= p95 && p95 <= max,
                "{series}"
            );
        }
    }
    let materials = profile["memory"]["materials"].as_array().unwrap();
    let bytes = |material: &Value| material["bytes"].as_u64().unwrap();
    let map = materials
        .iter()
        .find(|material| material["name"] == "shadow_maps")
        .unwrap();
    assert_eq!(
        (bytes(map), &map["size"]),
        (32 * 32 * 4, &serde_json::json!([32, 32]))
    );
    assert_eq!(
        materials.iter().map(bytes).sum::<u64>(),
        profile["memory"]["bytes"].as_u64().unwrap()
    );

    let csv = fs::read_to_string(folder.path().join("p.csv")).unwrap();
    assert_eq!(
        csv.lines().count(),
        1 + PASSES.len() + 1,
        "header, passes, frame:\n{csv}"
    );
    check_trace(&json(&folder.path().join("p.trace.json")), is_trusted);

    let report = text(&skiagraph(folder.path(), &format!("{NSM} --baseline p.json"), 0).stdout);
    assert!(
        report.contains("Against p.json") && !report.contains("WARNING"),
        "{report}"
    );
}

/// Checks the needs of a viewer beside the schema: slices of one track do not overlap, every track
/// has a name.
fn check_trace(trace: &Value, is_trusted: bool) {
    let schema: Value = serde_json::from_str(include_str!("trace.schema.json")).unwrap();
    let validator = jsonschema::validator_for(&schema).unwrap();
    let faults: Vec<String> = validator
        .iter_errors(trace)
        .map(|fault| format!("{}: {fault}", fault.instance_path()))
        .collect();
    assert_eq!(faults, [] as [String; 0]);
    let mut broken = trace.clone();
    broken["traceEvents"][4]["dur"] = "long".into();
    assert!(!validator.is_valid(&broken), "the schema finds mistakes");

    let events = trace["traceEvents"].as_array().unwrap();
    let mut tracks: BTreeMap<u64, Vec<(f64, f64)>> = BTreeMap::new();
    for event in events.iter().filter(|event| event["ph"] == "X") {
        let number = |key: &str| event[key].as_f64().unwrap();
        let slices = tracks.entry(event["tid"].as_u64().unwrap()).or_default();
        slices.push((number("ts"), number("ts") + number("dur")));
    }
    for (track, slices) in &mut tracks {
        let is_named = |event: &&Value| event["name"] == "thread_name" && event["tid"] == *track;
        assert_eq!(events.iter().filter(is_named).count(), 1, "track {track}");
        slices.sort_by(|a, b| a.0.total_cmp(&b.0));
        for pair in slices.windows(2) {
            // Microseconds with three digits behind the point.
            assert!(pair[0].1 <= pair[1].0 + 1e-4, "track {track}: {pair:?}");
        }
    }
    let count = |category: &str| {
        events
            .iter()
            .filter(|event| event["cat"] == category)
            .count()
    };
    assert_eq!(count("frame"), 6);
    assert_eq!(count("cpu"), 6 * PASSES.len());
    assert_eq!(count("gpu"), if is_trusted { 6 * PASSES.len() } else { 0 });
}

#[test]
fn a_baseline_that_is_none_is_shown_before_anything_runs() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(
        folder.path().join("old.json"),
        "{\n  \"schema\": 1,\n  \"runs\": [}\n",
    )
    .unwrap();
    let refused = |line: &str| {
        let output = program(folder.path(), line)
            .env("VK_ICD_FILENAMES", "/nonexistent")
            .env("VK_DRIVER_FILES", "/nonexistent")
            .output()
            .unwrap();
        (output.status.code(), text(&output.stderr))
    };
    let (code, message) = refused("profile nsm --baseline old.json");
    assert_eq!(code, Some(1), "{message}");
    assert!(
        message.contains("old.json:3:12") && message.contains("profile --json"),
        "{message}"
    );
    let (code, message) = refused("profile nsm --baseline nowhere.json");
    assert_eq!(code, Some(1), "{message}");
    assert!(message.contains("nowhere.json"), "{message}");
}

#[test]
#[ignore = "a suite: `./test.sh --all` runs it"]
fn several_stand_beside_each_other() {
    let folder = tempfile::tempdir().unwrap();
    let line = "profile rt nsm@cull=none --view all --size 16x16,24x16 --map-size 16 --frames 2 \
                --warmup 0 --csv all.csv";
    let output = skiagraph(folder.path(), line, 0);
    let (shown, stderr) = (text(&output.stdout), text(&output.stderr));
    assert!(
        stderr.contains("--map-size has no effect on rt"),
        "{stderr}"
    );
    for part in [
        "rt",
        "nsm@cull=none",
        "bench_side",
        "24x16",
        "map 16",
        "whole frame",
    ] {
        assert!(shown.contains(part), "{part}: {shown}");
    }
    let csv = fs::read_to_string(folder.path().join("all.csv")).unwrap();
    let frames = csv.lines().filter(|line| line.contains(",frame,"));
    // Nine views in two sizes: rt and nsm.
    assert_eq!(frames.count(), 9 * 2 * 2);
}

#[test]
fn arguments_that_do_not_go_together_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    for (line, code, part) in [
        (
            "profile nsm rt --size 16x16 --json a.json",
            2,
            "--json is of one profile, and 2 are asked for",
        ),
        (
            "profile nsm --json a.json --trace ./a.json",
            2,
            "--json and --trace both write",
        ),
        (
            "profile nsm --csv nowhere/a.csv",
            1,
            "there is no folder nowhere",
        ),
        (
            "profile nsm --set map_sizes=4",
            1,
            "did you mean `map_size`?",
        ),
    ] {
        let message = text(&skiagraph(folder.path(), line, code).stderr);
        assert!(message.contains(part), "{line}: {message}");
    }
}

/// Ctrl-C: what was timed until then is shown and written, and the exit code is the shell's for an
/// interrupt.
#[cfg(unix)]
#[test]
fn an_interrupt_keeps_the_frames_that_were_timed() {
    use std::io::{BufRead, BufReader, Read};
    let folder = tempfile::tempdir().unwrap();
    let line = "profile nsm --size 16x16 --map-size 16 --frames 100000 --warmup 0 --json p.json";
    let mut child = program(folder.path(), line)
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut progress = BufReader::new(child.stderr.take().unwrap());
    let mut line = String::new();
    while !line.starts_with("starting nsm") {
        line.clear();
        assert_ne!(
            progress.read_line(&mut line).unwrap(),
            0,
            "it ended before it began"
        );
    }
    let sent = Command::new("kill")
        .args(["-INT", &child.id().to_string()])
        .status()
        .unwrap();
    assert!(sent.success());
    let mut rest = String::new();
    progress.read_to_string(&mut rest).unwrap();
    assert_eq!(child.wait().unwrap().code(), Some(130), "{rest}");
    // The signal may be faster than the first frame.
    match fs::read(folder.path().join("p.json")) {
        Ok(written) => {
            let profile: Value = serde_json::from_slice(&written).unwrap();
            let timed = profile["frame"]["wall_ms"]["samples"]
                .as_array()
                .unwrap()
                .len();
            assert!(
                rest.contains(&format!("the {timed} of 100000 frames")),
                "{rest}"
            );
        }
        // Or faster than the driver, which compiles a shader.
        Err(_) => assert!(
            rest.contains("no frame was timed") || rest.contains("what was under way is lost"),
            "{rest}"
        ),
    }
}
