//! Failures while the program runs: docs/faults.md has a row for each of these.
#![cfg(unix)]

use serde_json::Value;
use std::{
    fs,
    io::{BufRead, BufReader, Read},
    path::Path,
    process::{Command, Output, Stdio},
    thread,
    time::Duration,
};
use tempfile::TempDir;

/// A shadow method of one compute pass and its shader's body.
fn method(folder: &Path, name: &str, groups: &str, body: &str) {
    let graph = format!(
        r#"(
    format: 3,
    materials: [
        Texture(name: "visibility", format: R32Uint),
        Texture(name: "status", format: R8Uint),
    ],
    passes: [
        Compute(name: "{name}", dispatch: {groups}),
        Clear(name: "certain", target: "status", value: 2),
    ],
    outputs: ["visibility", "status"],
)"#
    );
    let shader = format!(
        "var visibility: texture_storage_2d<r32uint, write>;\n@compute @workgroup_size(8, 8)\n\
         fn main(@builtin(global_invocation_id) id: vec3u) {{\n{body}}}\n"
    );
    fs::write(folder.join(format!("{name}.ron")), graph).unwrap();
    fs::write(folder.join(format!("{name}.wgsl")), shader).unwrap();
}

const LIGHT: &str = "    textureStore(visibility, id.xy, vec4u(1u));\n";

/// Ends for no invocation by itself. A driver that breaks long loops off (lavapipe, after 65,535
/// rounds) has so many invocations to do it for that hours go by.
fn endless(folder: &Path) {
    let body = "    var state = id.x | 1u;\n    while state != 0u {\n        state = state * \
        1664525u | 1u;\n    }\n    \
                textureStore(visibility, id.xy, vec4u(state));\n";
    method(folder, "endless", "Groups(65535, 4096, 1)", body);
}

fn folder() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    method(folder.path(), "light", "Over(\"visibility.size\")", LIGHT);
    folder
}

fn command(folder: &Path, line: &str) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_skiagraph"));
    command
        .args(line.split_whitespace())
        .current_dir(folder)
        .env("NO_COLOR", "1")
        .env("SKIAGRAPH_PROGRESS", "lines");
    command
}

/// Exit code, standard output and standard error.
fn run(folder: &Path, line: &str) -> (i32, String, String) {
    let Output {
        status,
        stdout,
        stderr,
    } = command(folder, line).output().unwrap();
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
    let code = status
        .code()
        .unwrap_or_else(|| panic!("{line}: ended by a signal: {status}"));
    (code, text(stdout), text(stderr))
}

/// Sends Ctrl-C some time `after` a line of standard error that begins with `at`; returns the exit
/// code and all of standard error.
fn interrupted(folder: &Path, line: &str, at: &str, after: Duration) -> (i32, String) {
    let mut child = command(folder, line)
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut stderr = BufReader::new(child.stderr.take().unwrap());
    let mut text = String::new();
    loop {
        let begin = text.len();
        let read = stderr.read_line(&mut text).unwrap();
        assert!(read > 0, "{line} ended before it said `{at}`:\n{text}");
        if text[begin..].starts_with(at) {
            break;
        }
    }
    thread::sleep(after);
    let signal = Command::new("kill")
        .args(["-INT", &child.id().to_string()])
        .status();
    assert!(signal.unwrap().success());
    stderr.read_to_string(&mut text).unwrap();
    let status = child.wait().unwrap();
    (status.code().unwrap_or(-1), text)
}

fn runs(folder: &Path) -> Vec<Value> {
    let text = fs::read_to_string(folder.join("results.json")).unwrap();
    let results: Value = serde_json::from_str(&text).unwrap();
    results["runs"].as_array().unwrap().clone()
}

#[test]
fn check_warns_of_what_not_every_adapter_can_and_asks_one_that_is_named() {
    let folder = folder();
    let light = fs::read_to_string(folder.path().join("light.ron")).unwrap();
    let wide = light.replace("R8Uint)", "R8Uint, size: 8193)");
    fs::write(folder.path().join("wide.ron"), wide).unwrap();
    let (code, stdout, stderr) = run(folder.path(), "check wide.ron");
    assert_eq!(
        (code, &*stdout),
        (
            0,
            "wide.ron: fine, 2 passes for 64×64 pixels, a small scene and one light\n"
        ),
        "{stderr}"
    );
    assert!(
        stderr.contains("8193") && stderr.contains("8192"),
        "{stderr}"
    );
    let needs = light.replace(
        "format: 3,",
        "format: 3, requires: [\"EXPERIMENTAL_MESH_SHADER\"],",
    );
    fs::write(folder.path().join("needs.ron"), needs).unwrap();
    let (code, _, stderr) = run(folder.path(), "check needs.ron");
    assert_eq!((code, &*stderr), (0, ""), "it says so itself");
    // Any adapter; its device never has this one.
    let (code, _, stderr) = run(folder.path(), "check needs.ron --adapter=");
    assert_eq!(code, 1, "{stderr}");
    assert!(stderr.contains("EXPERIMENTAL_MESH_SHADER"), "{stderr}");
    let (code, ..) = run(folder.path(), "check light.ron --adapter=");
    assert_eq!(code, 0);
    let (code, _, stderr) = run(folder.path(), "check light.ron --adapter no_such_adapter");
    assert_eq!(code, 3, "{stderr}");
}

/// Devices of this program never have experimental features but ray queries.
#[test]
fn a_feature_that_the_adapter_lacks_is_one_diagnostic_before_anything_runs() {
    let folder = folder();
    let light = fs::read_to_string(folder.path().join("light.ron")).unwrap();
    let needs = "format: 3,\n    requires: [\"EXPERIMENTAL_MESH_SHADER\"],";
    fs::write(
        folder.path().join("light.ron"),
        light.replace("format: 3,", needs),
    )
    .unwrap();
    for verb in ["run", "profile", "compare"] {
        let (code, stdout, stderr) = run(folder.path(), &format!("{verb} light.ron --size 16x16"));
        assert_eq!((code, &*stdout), (1, ""), "{verb}: {stderr}");
        let begin =
            "feature\n\n  × `light.ron` cannot run without the feature `EXPERIMENTAL_MESH_SHADER`";
        assert!(stderr.starts_with(begin), "{verb}: {stderr}");
        assert!(stderr.ends_with("1 error in 1 graph\n"), "{verb}: {stderr}");
    }
}

/// The limit is lifted above what the driver has: its own refusal tells as much as the planner's.
#[test]
fn a_driver_without_memory_names_the_material_with_the_table() {
    let folder = tempfile::tempdir().unwrap();
    let graph = "(format: 3, materials: [Texture(name: \"image\", format: Rgba32Float, size: 8192, \
                 layers: 256)], \
                 passes: [Clear(name: \"clear\", target: \"image\")], outputs: [\"image\"])";
    fs::write(folder.path().join("huge.ron"), graph).unwrap();
    let line = "run huge.ron --size 16x16 --memory-limit 1000000GiB";
    let (code, _, stderr) = run(folder.path(), line);
    assert_eq!(code, 1, "{stderr}");
    let words = stderr.split_whitespace().collect::<Vec<_>>().join(" ");
    for part in [
        "because: the device has not enough memory for `image`",
        "image 8192×8192, 256 layers Rgba32Float 256.00 GiB",
        "all together 256.00 GiB",
    ] {
        assert!(words.contains(part), "no `{part}` in {stderr}");
    }
}

#[test]
#[ignore = "a suite: `./test.sh --all` runs it"]
fn a_shader_that_never_ends_is_given_up_and_finished_runs_are_kept() {
    let folder = folder();
    endless(folder.path());
    let line = "compare light.ron endless.ron rt --size 16x16 --frames 1 --images none --timeout \
        3 --out o";
    let (code, _, stderr) = run(folder.path(), line);
    assert_eq!(code, 3, "{stderr}");
    assert!(
        stderr.contains("error: `endless.ron` cannot run\n"),
        "{stderr}"
    );
    // A GPU whose driver resets it first is lost instead.
    let hangs = "in it ran endless, certain\n";
    assert!(
        stderr.contains(hangs) || stderr.contains("the device was lost"),
        "{stderr}"
    );
    assert!(stderr.contains("1 of 3 runs are kept"), "{stderr}");
    let kept = runs(&folder.path().join("o"));
    assert_eq!(kept.len(), 1);
    assert_eq!(kept[0]["preset"], "light.ron");
    for verb in ["run", "profile"] {
        let line = format!("{verb} endless.ron --size 16x16 --timeout 1");
        let (code, _, stderr) = run(folder.path(), &line);
        assert_eq!(code, 3, "{verb}: {stderr}");
    }
}

#[test]
fn ctrl_c_in_a_frame_that_never_ends_keeps_finished_runs_and_resume_goes_on() {
    let folder = folder();
    endless(folder.path());
    let out = folder.path().join("o");
    let line = "compare light.ron endless.ron --size 16x16 --frames 1 --timeout 0 --out o";
    let (code, stderr) = interrupted(folder.path(), line, "starting endless.ron", Duration::ZERO);
    assert_eq!(code, 130, "{stderr}");
    assert!(
        stderr.contains("stopped by Ctrl-C; 1 of 2 runs are kept in o/results.json"),
        "{stderr}"
    );
    let kept = runs(&out);
    assert_eq!(kept.len(), 1);
    assert!(out.join("results.csv").is_file());
    // The author mends the shader; only that method has to be measured.
    method(folder.path(), "endless", "Over(\"visibility.size\")", LIGHT);
    // The other one lacks its turns.
    assert!(kept[0].get("turns").is_none());
    let (code, _, stderr) = run(folder.path(), &format!("{line} --resume"));
    assert_eq!(code, 0, "{stderr}");
    let resumed = runs(&out);
    assert_eq!(
        (resumed.len(), &resumed[0]["wrong"]),
        (2, &kept[0]["wrong"])
    );
    assert_eq!(resumed[1]["preset"], "endless.ron");
    let (_, _, stderr) = run(folder.path(), &format!("{line} --resume"));
    assert!(stderr.contains("2 of 2 runs are kept"), "{stderr}");
    assert!(!stderr.contains("starting"), "{stderr}");
}

#[test]
fn ctrl_c_between_frames_keeps_what_is_judged_and_resume_times_it() {
    let folder = folder();
    for frames in [
        "--frames 100000 --regime-frames 0",
        "--frames 1 --regime-frames 100000",
    ] {
        let line = format!("compare nsm --size 16x16 --map-size 16 --warmup 0 {frames} --out o");
        // So long that the one frame is over and the cached ones have begun; where they have not,
        // this still holds.
        let after = Duration::from_secs(1);
        let (code, stderr) = interrupted(folder.path(), &line, "starting 1 method in turns", after);
        assert_eq!(code, 130, "{frames}: {stderr}");
        assert!(
            stderr.contains("1 of 1 runs are kept"),
            "{frames}: {stderr}"
        );
        let kept = runs(&folder.path().join("o"));
        assert!(kept[0]["wrong"].is_object() && kept[0].get("turns").is_none());
        fs::remove_dir_all(folder.path().join("o")).unwrap();
    }
}

#[test]
fn ctrl_c_in_the_reference_ends_with_nothing_half_done() {
    let folder = folder();
    let line = "compare light.ron --size 2048x2048 --frames 1 --out o";
    let (code, stderr) = interrupted(folder.path(), line, "starting reference", Duration::ZERO);
    assert_eq!(code, 130, "{stderr}");
    assert!(
        stderr.contains("stopped by Ctrl-C; no run was finished"),
        "{stderr}"
    );
    assert!(!folder.path().join("o/results.json").exists());
}

/// Neither a mesh that is made nor a hierarchy that is built looks for a stop.
#[test]
fn ctrl_c_ends_the_program_in_the_middle_of_work_that_takes_no_notice() {
    let folder = folder();
    let city = "--scene city:1000000 --size 16x16 --out o";
    let loading = format!("compare rt --map-size 64 --frames 1 {city}");
    let hierarchy = format!("compare light.ron --frames 1 {city}");
    let lost = "what was under way is lost";
    for (line, at, outcome) in [
        (loading, "--map-size has no effect", lost),
        (
            hierarchy,
            "starting hierarchy of city",
            "no run was finished",
        ),
        (format!("truth {city}"), "starting hierarchy of city", lost),
    ] {
        let (code, stderr) = interrupted(folder.path(), &line, at, Duration::ZERO);
        assert_eq!(code, 130, "{line}: {stderr}");
        assert!(
            stderr.contains(&format!("stopped by Ctrl-C; {outcome}")),
            "{line}: {stderr}"
        );
        assert!(!folder.path().join("o/results.json").exists(), "{line}");
    }
}

/// Names of the files in a folder.
fn files(folder: &Path) -> Vec<String> {
    let files = fs::read_dir(folder).unwrap();
    let names = files.map(|file| file.unwrap().file_name().into_string().unwrap());
    names.collect()
}

/// All files of a truth belong together.
#[test]
fn ctrl_c_while_files_are_written_leaves_none_out_and_a_second_one_no_part_of_one() {
    let folder = folder();
    let out = folder.path().join("o");
    let line = "truth --scene park --size 768x512 --out o";
    let (code, stderr) = interrupted(folder.path(), line, "blockers, ", Duration::ZERO);
    assert_eq!(code, 0, "{stderr}");
    let written = files(&out);
    assert_eq!(written.len(), 8, "{written:?}");
    for pause in [100, 300] {
        let mut child = command(folder.path(), line)
            .stdout(Stdio::null())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        let mut lines = BufReader::new(child.stderr.take().unwrap()).lines();
        lines.find(|line| line.as_ref().unwrap().starts_with("blockers, "));
        for pause in [0, pause] {
            thread::sleep(Duration::from_millis(pause));
            let id = child.id().to_string();
            Command::new("kill").args(["-INT", &id]).status().unwrap();
        }
        child.wait().unwrap();
        let parts = files(&out);
        let parts = parts.iter().filter(|name| name.starts_with(".skiagraph-"));
        assert_eq!(parts.count(), 0, "{pause}");
    }
}

/// Scenes and methods are named by text; the argument is shown with the way out.
#[test]
fn an_argument_that_is_not_utf_8_is_named_with_the_way_out() {
    use std::{ffi::OsStr, os::unix::ffi::OsStrExt};
    let mut command = command(Path::new("."), "compare rt --scene");
    let output = command
        .arg(OsStr::from_bytes(b"bl\xe4tter.obj"))
        .output()
        .unwrap();
    let stderr = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(2), "{stderr}");
    let message = r#"error: the argument "bl\xE4tter.obj" is not UTF-8"#;
    assert!(
        stderr.starts_with(message) && stderr.contains("rename the file"),
        "{stderr}"
    );
}

#[test]
fn an_out_that_takes_no_files_is_found_before_anything_is_measured() {
    let folder = folder();
    for out in ["light.ron/o", "light.ron", "/dev/null/o"] {
        let line = format!("compare light.ron --size 16x16 --out {out}");
        let (code, stdout, stderr) = run(folder.path(), &line);
        assert_eq!((code, &*stdout), (1, ""), "{out}: {stderr}");
        assert!(
            stderr.starts_with(&format!("error: cannot write {out}\n")),
            "{stderr}"
        );
        assert!(stderr.contains("name another one"), "{stderr}");
        assert!(!stderr.contains("starting"), "{stderr}");
    }
    let (code, stdout, stderr) = run(folder.path(), "profile light.ron --size 16x16 --csv .");
    assert_eq!((code, &*stdout), (1, ""));
    assert!(
        stderr.contains("--csv: cannot write .: it is a folder"),
        "{stderr}"
    );
}

/// Devices are written into, never replaced: this one is always full.
#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_is_named_with_the_way_out() {
    let folder = folder();
    let full = folder.path().join("full.bin");
    std::os::unix::fs::symlink("/dev/full", &full).unwrap();
    let (code, _, stderr) = run(
        folder.path(),
        "run light.ron --size 16x16 --save visibility=full.bin",
    );
    assert_eq!(code, 1, "{stderr}");
    assert!(
        stderr.starts_with("error: cannot write full.bin\n"),
        "{stderr}"
    );
    assert!(stderr.contains("make room on the disk"), "{stderr}");
    assert!(fs::symlink_metadata(&full).unwrap().is_symlink());
    let files = [
        ("--csv", "profile"),
        ("--json", "profile"),
        ("--trace", "profile"),
        ("--out", "graph"),
    ];
    for (option, verb) in files {
        let line = format!("{verb} light.ron --size 16x16 {option} full.bin");
        let (code, _, stderr) = run(folder.path(), &line);
        assert_eq!(code, 1, "{verb} {option}: {stderr}");
        assert!(stderr.contains("make room on the disk"), "{stderr}");
    }
}
