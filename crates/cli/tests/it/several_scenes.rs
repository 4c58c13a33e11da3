//! Several scenes in one run: a folder for each, and an overview of all.

use crate::support::skiagraph;
use serde_json::Value;
use std::{
    fs,
    io::{BufRead, BufReader, Read},
    path::Path,
    process::{Command, Output, Stdio},
};
use tempfile::TempDir;

const COMPARE: &str = "compare rt nsm --size 64x64 --map-size 64 --frames 1 --warmup 0 --images \
                       none --out out";
const SCENES: &str = "--scene room.gltf --scene objects.gltf";

/// A folder with two of the files of `own_scene/`.
fn folder() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    let files = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/it/own_scene"));
    for name in ["room.gltf", "objects.gltf"] {
        fs::copy(files.join(name), folder.path().join(name)).unwrap();
    }
    folder
}

/// Returns standard output and standard error of the program, and its exit code.
fn printed(folder: &TempDir, line: &str) -> (String, String, Option<i32>) {
    let Output {
        status,
        stdout,
        stderr,
    } = skiagraph(folder.path(), line);
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    (text(&stdout), text(&stderr), status.code())
}

#[test]
fn each_scene_has_a_folder_and_all_stand_in_one_overview() {
    let folder = folder();
    let out = folder.path().join("out");
    let (table, stderr, code) = printed(&folder, &format!("{COMPARE} {SCENES}"));
    assert_eq!(code, Some(0), "{stderr}");
    let overview = &table[table.find("Overview, 64x64: ").unwrap()..];
    let heads = overview
        .lines()
        .find(|line| line.contains("method"))
        .unwrap();
    let heads: Vec<&str> = heads.split_whitespace().collect();
    assert_eq!(heads, ["method", "room", "objects"]);
    for part in ["\nroom: ", "\nobjects: ", "\nOn both scenes exact: `rt`."] {
        assert!(overview.contains(part), "no {part:?} in {overview}");
    }
    let table = overview.lines().skip(1);
    let table = table.take_while(|line| !line.contains(": "));
    let widths: Vec<usize> = table.map(|line| line.chars().count()).collect();
    assert!(
        widths.len() > 3 && widths.iter().all(|width| *width <= 80),
        "{overview}"
    );
    for scene in ["room", "objects"] {
        assert!(stderr.contains(&format!("are in out/{scene}")), "{stderr}");
        for file in ["results.json", "results.csv", "report.html"] {
            assert!(out.join(scene).join(file).is_file(), "{scene}/{file}");
        }
    }
    assert!(!out.join("results.json").exists());
    let page = fs::read_to_string(out.join("report.html")).unwrap();
    assert!(page.contains("data-choose=\"0\"") && page.contains("data-choose=\"1\""));
    // The page of a scene has no overview.
    let page = fs::read_to_string(out.join("room/report.html")).unwrap();
    assert!(!page.contains("data-choose=\""));
    // Nothing is measured anew.
    let (json, stderr, _) = printed(
        &folder,
        &format!("{COMPARE} {SCENES} --resume --format json"),
    );
    for scene in ["room", "objects"] {
        let kept = format!("2 of 2 runs are kept from out/{scene}/results.json");
        assert!(stderr.contains(&kept), "no {kept:?} in {stderr}");
    }
    let results: Vec<Value> = serde_json::from_str(&json).unwrap();
    let names: Vec<&str> = results
        .iter()
        .map(|record| record["scene"]["name"].as_str().unwrap())
        .collect();
    assert_eq!(names, ["room", "objects"]);
    // The folder of all stands for those in it.
    let (_, stderr, code) = printed(&folder, "report out --out all.html");
    assert_eq!(code, Some(0), "{stderr}");
    let page = fs::read_to_string(folder.path().join("all.html")).unwrap();
    assert!(page.contains("data-choose=\"1\""));
}

#[test]
fn what_a_scene_lacks_is_told_with_its_name_before_any_is_measured() {
    let folder = folder();
    for (rest, code, expected) in [
        (
            "--view door_cam",
            1,
            "the scene `objects` has no view `door_cam`",
        ),
        (
            "--light torch",
            1,
            "of the scene `objects` has no light `torch`",
        ),
        ("--path turn", 1, "the scene `room` has no camera paths"),
        (
            "--eye 0,1,2",
            2,
            "--eye is of one scene, and 2 are asked for; write a scene file",
        ),
        (
            "--write-scene a.ron",
            2,
            "--write-scene is of one scene, and 2 are",
        ),
    ] {
        let (table, stderr, exit) = printed(&folder, &format!("{COMPARE} {SCENES} {rest}"));
        assert_eq!(exit, Some(code), "{rest}: {stderr}");
        assert!(stderr.contains(expected), "no {expected:?} in {stderr}");
        assert_eq!(table, "", "{rest}");
        assert!(!folder.path().join("out/room/results.json").exists());
    }
    let (_, stderr, code) = printed(&folder, &format!("run rt {SCENES}"));
    assert_eq!(code, Some(2), "{stderr}");
    assert!(stderr.contains("cannot be used multiple times"), "{stderr}");
}

#[test]
fn a_gate_holds_on_every_scene() {
    let folder = folder();
    let line = format!("{COMPARE} {SCENES} --format markdown");
    let gate = ["--fail-if", "nsm: memory > 1"];
    let output = Command::new(env!("CARGO_BIN_EXE_skiagraph"))
        .args(line.split_whitespace().chain(gate))
        .current_dir(folder.path())
        .output()
        .unwrap();
    let stderr = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(4), "{stderr}");
    for scene in ["room", "objects"] {
        let line = format!("{scene}: `nsm 64` at 64x64: memory ");
        assert!(stderr.contains(&line), "no {line:?} in {stderr}");
    }
    let document = String::from_utf8_lossy(&output.stdout);
    assert!(document.contains("## Overview, 64x64\n"), "{document}");
}

#[cfg(unix)]
#[test]
fn ctrl_c_keeps_the_scenes_that_are_finished() {
    let folder = folder();
    let line = COMPARE.replace("--frames 1", "--frames 300");
    let mut child = Command::new(env!("CARGO_BIN_EXE_skiagraph"))
        .args(format!("{line} {SCENES}").split_whitespace())
        .current_dir(folder.path())
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut stderr = BufReader::new(child.stderr.take().unwrap());
    let mut text = String::new();
    while !text.ends_with("objects, scene 2 of 2\n") {
        assert!(stderr.read_line(&mut text).unwrap() > 0, "{text}");
    }
    let signal = Command::new("kill")
        .args(["-INT", &child.id().to_string()])
        .status();
    assert!(signal.unwrap().success());
    stderr.read_to_string(&mut text).unwrap();
    assert_eq!(child.wait().unwrap().code(), Some(130), "{text}");
    for part in [
        "stopped by Ctrl-C; scenes finished: 1 of 2; objects: ",
        "the same command with --resume goes on from there",
    ] {
        assert!(text.contains(part), "no {part:?} in {text}");
    }
    let out = folder.path().join("out");
    assert!(out.join("room/results.json").exists() && out.join("report.html").exists());
}
