//! A team's own CI: results against older ones, results of several machines, completions.

use crate::support::{results, skiagraph};
use serde_json::Value;
use std::{fs, path::Path};

const COMPARE: &str = "compare nsm light_buffer --scene park --size 48x48 --map-size 32 --frames 2 \
                       --warmup 0 --regime-frames 0 --images none";

fn read(file: &Path) -> Value {
    serde_json::from_str(&fs::read_to_string(file).unwrap()).unwrap()
}

#[test]
fn a_baseline_is_held_and_growth_has_an_exit_code_of_its_own() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let (runs, _) = results(folder, &format!("{COMPARE} --out out"));
    let cell = |run: &Value| run["cell"].as_str().unwrap().to_owned();
    assert!(runs.iter().all(|run| cell(run).len() == 16));
    assert_ne!(cell(&runs[0]), cell(&runs[1]));
    let against = |old: &str, more: &str| {
        let output = skiagraph(
            folder,
            &format!("{COMPARE} --out new {more} --baseline {old}"),
        );
        let [stdout, stderr] =
            [&output.stdout, &output.stderr].map(|it| String::from_utf8_lossy(it));
        (output.status.code(), format!("{stdout}{stderr}"))
    };
    let (code, output) = against("out", "");
    assert_eq!(code, Some(0), "{output}");
    assert!(output.contains("0 worse, 0 better, 2 the same"), "{output}");
    assert!(
        output.contains("times are not compared: "),
        "two frames are too few: {output}"
    );

    // One that had a wrong pixel less, and one of another scene.
    let mut old = read(&folder.join("out/results.json"));
    let wrong = &mut old["runs"][0]["wrong"]["total"];
    *wrong = (wrong.as_u64().unwrap() - 1).into();
    fs::write(folder.join("old.json"), old.to_string()).unwrap();
    let (code, output) = against("old.json", "");
    assert_eq!(code, Some(5), "{output}");
    assert!(
        output.contains("`nsm 32` on bench_side 48x48 is more wrong: wrong "),
        "{output}"
    );
    let (code, output) = against("old.json", "--oracle offset:0.1");
    assert_eq!(code, Some(1), "{output}");
    assert!(
        output.contains("oracle: there exact, here offset:0.1"),
        "{output}"
    );
    for (missing, why) in [
        ("nowhere", "there is no folder"),
        ("no.json", "there is no file"),
    ] {
        let (code, output) = against(missing, "");
        assert!(code == Some(1) && output.contains(why), "{output}");
    }
}

#[test]
fn results_of_machines_are_merged_and_bad_ones_are_told() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    results(folder, &format!("{COMPARE} --out out"));
    let mut far = read(&folder.join("out/results.json"));
    far["machine"]["host"] = "far".into();
    for run in far["runs"].as_array_mut().unwrap() {
        run["machine"]["host"] = "far".into();
    }
    fs::write(folder.join("far.json"), far.to_string()).unwrap();
    let output = skiagraph(folder, "merge out far.json --out all");
    let stderr = String::from_utf8_lossy(&output.stderr);
    assert!(
        output.status.success() && stderr.contains("2 groups of results"),
        "{stderr}"
    );
    let merged = read(&folder.join("all/results.json"));
    assert_eq!(merged["others"][0]["machine"]["host"], "far");
    assert_eq!(merged["runs"].as_array().unwrap().len(), 2);
    let csv = fs::read_to_string(folder.join("all/results.csv")).unwrap();
    assert_eq!(csv.lines().count(), 5);
    assert!(folder.join("all/report.html").is_file());
    // It cannot be compared into, and can be read.
    let output = skiagraph(folder, &format!("{COMPARE} --out all"));
    let stderr = String::from_utf8_lossy(&output.stderr);
    assert!(
        stderr.contains("joined results: there 1, here 0"),
        "{stderr}"
    );
    assert!(skiagraph(folder, "report all").status.success());

    fs::write(folder.join("foreign.json"), "{}").unwrap();
    for (line, why) in [
        ("merge nowhere --out x", "there is no folder nowhere"),
        (
            "merge foreign.json --out x",
            "`foreign.json` is not a results.json",
        ),
    ] {
        let output = skiagraph(folder, line);
        let stderr = String::from_utf8_lossy(&output.stderr);
        assert!(
            output.status.code() == Some(1) && stderr.contains(why),
            "{stderr}"
        );
    }
    assert!(!folder.join("x").exists());
}

#[test]
fn each_shell_completes_all_commands() {
    let folder = tempfile::tempdir().unwrap();
    for shell in ["bash", "zsh", "fish", "powershell", "elvish"] {
        let output = skiagraph(folder.path(), &format!("completions {shell}"));
        let script = String::from_utf8_lossy(&output.stdout);
        for word in ["compare", "merge", "baseline"] {
            assert!(script.contains(word), "{shell} lacks {word}");
        }
    }
}
