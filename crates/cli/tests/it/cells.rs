//! A comparison in cells, on several processes as on several machines. Needs an adapter.

use crate::support::{results, skiagraph};
use serde_json::Value;
use std::{
    fs,
    path::{Path, PathBuf},
    process::{Child, Command, Output, Stdio},
    thread,
    time::Duration,
};

const COMPARE: &str = "compare rt nsm pcf vsm --set filterable=false --scene park --view all \
                       --size 32x32,48x32 --map-size 32 --frames 2 --warmup 0 --regime-frames 0";

/// The same on every machine with one adapter and driver.
const ANSWERS: [&str; 14] = [
    "preset",
    "view",
    "viewport",
    "fingerprint",
    "params",
    "pixels",
    "band",
    "certain",
    "uncertain",
    "split",
    "wrong",
    "graded",
    "edges",
    "texels",
];

fn told(output: &Output) -> String {
    let both = [&output.stdout, &output.stderr].map(|it| String::from_utf8_lossy(it));
    both.concat()
}

/// Runs the program, which must end with this exit code, and returns what it tells.
#[track_caller]
fn ends(folder: &Path, line: &str, code: i32) -> String {
    let output = skiagraph(folder, line);
    let streams = told(&output);
    assert_eq!(output.status.code(), Some(code), "{line}: {streams}");
    streams
}

fn begin(folder: &Path, line: &str) -> Child {
    Command::new(env!("CARGO_BIN_EXE_skiagraph"))
        .args(line.split_whitespace())
        .current_dir(folder)
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .expect("the program was built for this test")
}

fn files(folder: &Path, ending: &str) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    let mut files: Vec<PathBuf> = entries.map(|entry| entry.path()).collect();
    files.retain(|file| file.to_string_lossy().ends_with(ending));
    files.sort();
    files
}

fn read(file: &Path) -> Value {
    serde_json::from_str(&fs::read_to_string(file).unwrap()).unwrap()
}

fn lines(folder: &Path) -> Vec<Value> {
    let text = fs::read_to_string(folder.join("cells.jsonl")).unwrap();
    let lines = text.lines().map(|line| serde_json::from_str(line).unwrap());
    lines.collect()
}

#[test]
fn shards_that_are_killed_and_begun_again_equal_one_comparison() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let (runs, _) = results(folder, &format!("{COMPARE} --out out"));
    ends(folder, &format!("{COMPARE} --plan cells.jsonl"), 0);
    let lines = lines(folder);
    let of_kind = |kind: &str| lines.iter().filter(|line| line["kind"] == kind).count();
    assert_eq!(of_kind("cell"), runs.len());
    assert_eq!(of_kind("truth"), runs.len() / 4);
    assert!(!folder.join("measured").exists(), "nothing was measured");

    let shard = |number| format!("compare --cells cells.jsonl --shard {number}/2 --out measured");
    let cells = folder.join("measured/cells");
    // One that was judged has no times yet, and is measured again.
    let is_timed = |file: &PathBuf| read(file)["runs"][0]["turns"].is_object();
    let measured = || {
        files(&cells, ".json")
            .iter()
            .filter(|file| is_timed(file))
            .count()
    };
    let mut both = [1, 2].map(|number| begin(folder, &shard(number)));
    while measured() < 2 && both.iter_mut().all(|it| it.try_wait().unwrap().is_none()) {
        thread::sleep(Duration::from_millis(5));
    }
    for child in &mut both {
        child.kill().unwrap();
        child.wait().unwrap();
    }
    let before = measured();
    assert!(
        (2..runs.len()).contains(&before),
        "{before} cells were finished"
    );
    let missing = ends(folder, "merge measured --out part", 1);
    let left = format!(
        "{} of {} planned cells are not measured yet",
        runs.len() - before,
        runs.len()
    );
    assert!(
        missing.contains(&left) && missing.contains("--cells measured/cells.jsonl"),
        "{missing}"
    );

    // The second again and at once by another process, as if it had been requeued too early.
    let children = [1, 2, 2].map(|number| begin(folder, &shard(number)));
    for mut child in children {
        assert!(child.wait().unwrap().success());
    }
    assert_eq!(measured(), runs.len());
    let again = ends(folder, &shard(1), 0);
    let half = runs.len() / 2;
    assert!(
        again.contains(&format!(
            "{half} cells are in measured, {half} of them from before"
        )),
        "{again}"
    );
    assert_eq!(
        files(&folder.join("measured/truth"), ".truth").len(),
        runs.len() / 4
    );

    let joined = ends(folder, "merge measured --out measured", 0);
    assert!(
        joined.contains(&format!("park: {} runs of 1 folder", runs.len())),
        "{joined}"
    );
    let results = read(&folder.join("measured/results.json"));
    assert_eq!(results["plan"].as_str().map(str::len), Some(16));
    let joined = results["runs"].as_array().unwrap();
    assert_eq!(joined.len(), runs.len());
    for (one, other) in runs.iter().zip(joined) {
        assert_eq!(one["cell"], other["cell"], "in the order of the plan");
        for name in ANSWERS {
            assert_eq!(one[name], other[name], "{name} of {}", one["preset"]);
        }
        assert_eq!(one["images"], other["images"]);
    }
    for picture in [".png", ".svg"]
        .iter()
        .flat_map(|ending| files(&folder.join("out"), ending))
    {
        let other = folder.join("measured").join(picture.file_name().unwrap());
        assert!(
            fs::read(&picture).unwrap() == fs::read(&other).unwrap(),
            "{}",
            other.display()
        );
    }
    assert!(folder.join("measured/report.html").is_file());
}

#[test]
fn plans_that_cannot_be_measured_are_told_with_the_way_out() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let small = "compare rt nsm --scene park --size 16x16 --map-size 16 --frames 1 --warmup 0 \
                 --regime-frames 0 --images none";
    ends(folder, &format!("{small} --plan cells.jsonl"), 0);
    let good = fs::read_to_string(folder.join("cells.jsonl")).unwrap();
    let measure = |text: &str, code, parts: &[&str]| {
        fs::write(folder.join("cells.jsonl"), text).unwrap();
        let streams = ends(folder, "compare --cells cells.jsonl --out measured", code);
        for part in parts {
            assert!(streams.contains(part), "no {part:?} in {streams}");
        }
    };
    let torn = &good[..good.len() - 20];
    measure(
        torn,
        1,
        &[
            "`cells.jsonl` is not a plan of cells: EOF",
            "cells.jsonl:4",
            "--plan FILE",
        ],
    );
    let three: String = good.split_inclusive('\n').take(3).collect();
    measure(
        &three,
        1,
        &[
            "its first line says 2 cells, and 1 are there",
            "cells.jsonl:1",
        ],
    );
    let other = good.replacen("\"program\":\"skiagraph ", "\"program\":\"skiagraph 9.", 1);
    measure(
        &other,
        1,
        &[
            "the plan was written by skiagraph 9.",
            "and this is skiagraph 0",
            "plan anew",
        ],
    );
    let schema = good.replacen("\"schema\":1", "\"schema\":2", 1);
    measure(&schema, 1, &["version 1 of the schema, not 2"]);
    measure(
        "{\"schema\":1,\"kind\":\"profile\"}\n",
        1,
        &["its first line lacks \"kind\":\"cells\""],
    );
    measure("", 1, &["is not a plan of cells"]);
    let twice = good.clone() + good.lines().last().unwrap() + "\n";
    measure(
        &twice,
        1,
        &["is there twice, or not an id", "cells.jsonl:5"],
    );
    let last = good.rfind("\"fingerprint\":\"").unwrap() + "\"fingerprint\":\"".len();
    let shader = format!("{}0123{}", &good[..last], &good[last + 4..]);
    measure(
        &shader,
        1,
        &[
            "nsm on bench_side 16x16, map 16: its graph, shaders",
            "plan anew",
        ],
    );
    let param = good.replacen("\"cull\":\"", "\"cull\":\"un", 1);
    measure(
        &param,
        1,
        &["the param cull was planned as \"un", "--set cull=un"],
    );
    let command = good.replacen("\"compare\",", "\"compare\",\"--frame\",", 1);
    measure(
        &command,
        1,
        &["\"arguments\" are not those of a comparison", "--frame"],
    );
    assert!(!folder.join("measured").exists(), "nothing was measured");

    measure(
        &good,
        0,
        &["2 cells are in measured, 0 of them from before"],
    );
    ends(
        folder,
        &format!("{} --plan cells.jsonl", small.replace("16x16", "24x16")),
        0,
    );
    let streams = ends(folder, "compare --cells cells.jsonl --out measured", 1);
    assert!(
        streams.contains("measured holds the cells of another plan"),
        "{streams}"
    );
    ends(folder, &format!("{small} --out alone"), 0);
    let streams = ends(folder, "compare --cells cells.jsonl --out alone", 1);
    assert!(
        streams.contains("alone holds results of a comparison without a plan"),
        "{streams}"
    );
    let streams = ends(folder, &format!("{small} nsm@bias=0 --plan same.jsonl"), 1);
    assert!(streams.contains("are the same cell"), "{streams}");
    let streams = ends(folder, "compare --cells cells.jsonl --shard 4/3", 2);
    assert!(
        streams.contains("there is no shard 4 of 3; there are 1/3 to 3/3"),
        "{streams}"
    );
    let streams = ends(folder, "compare --cells cells.jsonl --frames 3", 2);
    assert!(streams.contains("--frames"), "{streams}");
    let streams = ends(folder, "compare --cells nowhere.jsonl", 1);
    assert!(
        streams.contains("cannot read the plan nowhere.jsonl"),
        "{streams}"
    );
}

#[test]
fn cells_of_two_machines_that_disagree_are_not_joined() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let small = "compare rt nsm --scene park --size 16x16 --map-size 16 --frames 1 --warmup 0 \
                 --regime-frames 0 --images none";
    ends(folder, &format!("{small} --plan cells.jsonl"), 0);
    for line in ["--shard 1/2 --out one", "--out two"] {
        ends(folder, &format!("compare --cells cells.jsonl {line}"), 0);
    }
    let joined = ends(folder, "merge one two --out all", 0);
    assert!(
        joined.contains("1 of 2 cells were measured more than once and agree"),
        "{joined}"
    );
    assert_eq!(
        read(&folder.join("all/results.json"))["runs"]
            .as_array()
            .map(Vec::len),
        Some(2)
    );

    let merge = |parts: &[&str]| {
        let streams = ends(folder, "merge one two --out other", 1);
        for part in parts {
            assert!(streams.contains(part), "no {part:?} in {streams}");
        }
        assert!(!folder.join("other").exists(), "nothing was written");
    };
    let cell = files(&folder.join("one/cells"), ".json").remove(0);
    let good = fs::read(&cell).unwrap();
    let change = |change: &dyn Fn(&mut Value)| {
        let mut value = serde_json::from_slice(&good).unwrap();
        change(&mut value);
        fs::write(&cell, value.to_string()).unwrap();
    };
    change(&|value| value["runs"][0]["pixels"]["lit"] = 77_777.into());
    merge(&[
        "measured twice on one kind of adapter",
        "one/cells/",
        "two/cells/",
        "pixels.lit: 77777 and",
    ]);
    change(&|value| value["program"] = "skiagraph 0.0.9".into());
    merge(&[
        "was measured by skiagraph 0.0.9",
        "and the other cells by skiagraph 0.1",
        "delete that file",
    ]);
    change(&|value| value["runs"][0]["fingerprint"] = "0123".into());
    merge(&["was measured with another graph, shader, mesh, light or view"]);
    fs::write(&cell, &good[..good.len() / 2]).unwrap();
    merge(&["is not a results.json", "EOF"]);
    // Torn, it is measured anew.
    let streams = ends(
        folder,
        "compare --cells cells.jsonl --shard 1/2 --out one",
        0,
    );
    assert!(
        streams.contains("it is measured anew") && streams.contains("0 of them from before"),
        "{streams}"
    );
    // A plan of another version.
    let plan = fs::read_to_string(folder.join("one/cells.jsonl")).unwrap();
    let older = plan.replacen(
        "\"program\":\"skiagraph ",
        "\"program\":\"skiagraph 0.0.9 ",
        1,
    );
    fs::write(folder.join("one/cells.jsonl"), older).unwrap();
    merge(&[
        "one holds cells of skiagraph 0.0.9",
        "and two of skiagraph 0.1",
    ]);
    fs::write(folder.join("one/cells.jsonl"), plan).unwrap();
    // A reference of other bits.
    let truth = files(&folder.join("one/truth"), ".truth").remove(0);
    let mut bytes = fs::read(&truth).unwrap();
    bytes[50] ^= 1;
    fs::write(&truth, bytes).unwrap();
    merge(&[
        "have traced the same reference, and their bits differ",
        "one/truth/",
        "two/truth/",
    ]);
}

/// A comparison that is killed at any moment loses no cell that was judged, and `--resume` ends
/// with the same counts as one that was never killed.
#[test]
#[ignore = "a suite: `./test.sh --all` runs it"]
fn twenty_kills_lose_no_cell_that_was_judged() {
    let folder = tempfile::tempdir().unwrap();
    let line = "compare nsm pcf rt light_buffer --scene park --view all --size 24x24 \
                --map-size 16 --frames 2 --warmup 0 --regime-frames 1 --images none";
    let runs_in = |out: &str| -> Vec<Value> {
        let cells = files(&folder.path().join(out).join("cells"), ".json");
        cells
            .iter()
            .map(|file| read(file)["runs"][0].clone())
            .collect()
    };
    let cells = folder.path().join("killed/cells");
    let written = || cells.metadata().and_then(|cells| cells.modified()).ok();
    let (seed, mut random, mut kept) = (57u64, 57u64, 0);
    for kill in 0..20 {
        let before = written();
        let mut child = Command::new(env!("CARGO_BIN_EXE_skiagraph"))
            .args(format!("{line} --out killed --resume").split_whitespace())
            .current_dir(folder.path())
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        // Until a run is written, and some time after that.
        while written() == before && child.try_wait().unwrap().is_none() {
            thread::sleep(Duration::from_millis(5));
        }
        random = random
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1);
        thread::sleep(Duration::from_millis((random >> 33) % 700));
        // One that has ended by itself is no fault.
        let _ = child.kill();
        child.wait().unwrap();
        let runs = runs_in("killed").len();
        assert!(
            runs >= kept,
            "seed {seed}, kill {kill}: {runs} of {kept} runs"
        );
        kept = runs;
    }
    assert!(kept > 0, "no run was judged before a kill");
    skiagraph(folder.path(), &format!("{line} --out killed --resume"));
    skiagraph(folder.path(), &format!("{line} --out whole"));
    let answers = |out: &str| -> Vec<Value> {
        let runs = runs_in(out).into_iter();
        let answers = runs.map(|run| {
            assert!(run["turns"].is_object(), "{run}");
            ANSWERS.iter().map(|name| run[*name].clone()).collect()
        });
        let mut answers: Vec<Value> = answers.collect();
        answers.sort_by_key(Value::to_string);
        answers
    };
    assert_eq!(answers("killed"), answers("whole"));
    let joined = ["killed", "whole"].map(|out| {
        let results = read(&folder.path().join(out).join("results.json"));
        let runs = results["runs"].as_array().unwrap().clone().into_iter();
        runs.map(|run| run["cell"].clone()).collect::<Vec<Value>>()
    });
    assert_eq!(joined[0], joined[1], "in one order");
}
