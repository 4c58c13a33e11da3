//! `scripts/adapter.sh`: rows in processes of their own, kept and gone on with, and the tables that
//! `scripts/adapters.py` makes of them.

use crate::support::skiagraph;
use std::{
    fs,
    os::unix::fs::PermissionsExt,
    path::{Path, PathBuf},
    process::Command,
};

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

fn script(name: &str) -> PathBuf {
    let crates = Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap();
    crates.parent().unwrap().join("scripts").join(name)
}

/// Runs a program with the words of a line in a folder: exit code, and both streams as one text.
fn run(folder: &Path, program: &str, script: &Path, line: &str) -> (Option<i32>, String) {
    let mut command = Command::new(program);
    command.arg(script).args(line.split_whitespace());
    let output = command.current_dir(folder).output().unwrap();
    (
        output.status.code(),
        text(&output.stderr) + &text(&output.stdout),
    )
}

/// Runs the script with the program of this build.
fn survey(folder: &Path, line: &str) -> (Option<i32>, String) {
    let line = format!("--program {} {line}", env!("CARGO_BIN_EXE_skiagraph"));
    run(folder, "sh", &script("adapter.sh"), &line)
}

fn replace(file: &Path, old: &str, new: &str) {
    let text = fs::read_to_string(file).unwrap();
    assert!(text.contains(old), "{}", file.display());
    fs::write(file, text.replacen(old, new, 1)).unwrap();
}

#[test]
fn rows_are_kept_gone_on_with_and_joined() {
    let folder = tempfile::tempdir().unwrap();
    let place = |name: &str| folder.path().join(name);
    let line = "--small --out one --only hard,park";
    let (code, output) = survey(folder.path(), line);
    assert!(
        code == Some(0) && output.contains("1/2 hard: is") && output.contains("2/2 park: are"),
        "{output}"
    );
    for file in ["doctor.json", "hard/stress.json", "park/results.json"] {
        let text = fs::read_to_string(place("one").join(file)).unwrap();
        assert!(!text.contains("\"host\": \""), "{file}");
    }
    assert!(!place("one/park/report.html").exists(), "it names the host");

    // A row that was killed is run, one that is there is not.
    fs::remove_file(place("one/hard/row.txt")).unwrap();
    let (_, output) = survey(folder.path(), line);
    assert!(
        output.contains("1/2 hard: is") && output.contains("2/2 park: kept"),
        "{output}"
    );

    // Another adapter's folder is not gone on with, nor one of other files.
    let mut copy = Command::new("cp");
    copy.args(["-r", "one", "two"]).current_dir(&folder);
    assert!(copy.status().unwrap().success());
    let kind = fs::read_to_string(place("two/survey.txt")).unwrap();
    let driver = kind.lines().next().unwrap().rsplit(" · ").next().unwrap();
    for file in ["survey.txt", "doctor.json"] {
        let file = place("two").join(file);
        let text = fs::read_to_string(&file).unwrap();
        fs::write(file, text.replace(driver, "some driver 1.2")).unwrap();
    }
    let (code, output) = survey(folder.path(), "--small --out two --only hard");
    assert!(
        code == Some(1) && output.contains("some driver 1.2"),
        "{output}"
    );
    let (code, output) = survey(folder.path(), "--small --out one/hard --only hard");
    assert!(
        code == Some(1) && output.contains("other files"),
        "{output}"
    );

    let tables = script("adapters.py");
    let (code, output) = run(folder.path(), "python3", &tables, "one two --out all");
    assert!(
        code == Some(0) && output.contains("3 cells, 0 faults"),
        "{output}"
    );
    let page = fs::read_to_string(place("all/adapters.md")).unwrap();
    // The pixels of a view, and every cell as on the first.
    assert!(page.contains("| 0 of 2,304 |"), "{page}");
    assert!(page.contains("some driver 1.2 | 3 | 3 | 0.0000 | nsm on park"));
    replace(
        &place("two/park/results.json"),
        "\"in_band\": 0",
        "\"in_band\": -9",
    );
    let (code, output) = run(folder.path(), "python3", &tables, "one two");
    assert!(
        code == Some(1) && output.contains("9 wrong pixels outside"),
        "{output}"
    );

    let merged = skiagraph(folder.path(), "merge one --out all");
    assert!(merged.status.success(), "{}", text(&merged.stderr));
    assert!(place("all/report.html").exists() && place("all/results.json").exists());
}

/// A folder as `scripts/bundle.sh` makes it, of a program that is a shell script: it runs on an
/// adapter without ray queries, and each row of it ends as the file `end` says.
fn bundle(folder: &Path, backend: &str) -> PathBuf {
    let doctor = format!(
        r#"{{
  "adapter": {{
    "name": "a",
    "backend": "{backend}",
    "driver": "c",
    "device_type": "Cpu"
  }},
  "features": {{
    "ray_query": false
  }}
}}"#
    );
    let program = format!(
        "#!/bin/sh\ncase $1 in --version) echo p ;; doctor) echo '{doctor}' ;; *) . ./end ;; esac\n"
    );
    let place = folder.join("skiagraph");
    fs::write(&place, program).unwrap();
    fs::set_permissions(&place, fs::Permissions::from_mode(0o755)).unwrap();
    fs::copy(script("adapter.sh"), folder.join("adapter.sh")).unwrap();
    replace(&folder.join("adapter.sh"), "row hard 150", "row hard 3");
    folder.join("adapter.sh")
}

#[test]
fn every_end_is_told_from_the_others() {
    let folder = tempfile::tempdir().unwrap();
    let script = bundle(folder.path(), "vulkan");
    let row = folder.path().join("adapter-a-vulkan-c/hard/row.txt");
    let turn = |end: &str| {
        fs::write(folder.path().join("end"), end).unwrap();
        let (code, output) = run(folder.path(), "sh", &script, "--only hard --again");
        assert_eq!(code, Some(0), "{output}");
        (output, fs::read_to_string(&row).unwrap_or_default())
    };
    for (end, outcome) in [
        ("exit 0", "done\nexit: 0"),
        ("echo said >&2; exit 1", "failed\nexit: 1"),
        ("exit 3", "device lost\nexit: 3"),
        ("exit 101", "crashed\nexit: 101"),
        ("kill -SEGV $$", "crashed\nexit: 139"),
        ("exec sleep 60", "timed out\nexit: 137"),
    ] {
        let (output, record) = turn(end);
        assert!(
            record.contains(&format!("outcome: {outcome}\n")),
            "{record}"
        );
        assert_eq!(
            output.contains("(exit 1): said"),
            end.contains("said"),
            "{output}"
        );
    }
    // Not by SIGINT, which a shell's background jobs ignore.
    for end in ["kill -TERM $$", "exit 130"] {
        let (output, record) = turn(end);
        assert!(output.contains("not finished: hard;"), "{output}");
        assert_eq!(record, "", "it is run again");
    }
}

#[test]
fn rows_that_cannot_run_are_left_out() {
    for (backend, row) in [("gl", "hard_area"), ("vulkan", "hard_ray_query")] {
        let folder = tempfile::tempdir().unwrap();
        let script = bundle(folder.path(), backend);
        fs::write(folder.path().join("end"), "exit 1").unwrap();
        let line = format!("--only hard_area,hard_ray_query --out {backend}");
        let (code, output) = run(folder.path(), "sh", &script, &line);
        assert_eq!(code, Some(0), "{output}");
        let record = folder.path().join(backend).join(row).join("row.txt");
        let record = fs::read_to_string(record).unwrap();
        assert!(
            record.contains("outcome: not on this adapter\n"),
            "{record}"
        );
    }
}

#[test]
fn a_survey_is_alone_in_its_folder_and_leaves_it_when_it_ends() {
    let folder = tempfile::tempdir().unwrap();
    let script = bundle(folder.path(), "vulkan");
    let end = folder.path().join("end");
    fs::write(&end, "touch began; exec sleep 60").unwrap();
    let mut command = Command::new("sh");
    command
        .arg(&script)
        .args(["--only", "hard_area", "--out", "o"]);
    let mut first = command.current_dir(&folder).spawn().unwrap();
    while !folder.path().join("began").exists() {
        std::thread::sleep(std::time::Duration::from_millis(20));
    }
    let again = || run(folder.path(), "sh", &script, "--only hard_area --out o");
    let (code, output) = again();
    assert!(
        code == Some(1) && output.contains("is at work in"),
        "{output}"
    );
    let id = first.id().to_string();
    let killed = Command::new("kill").arg(id).status().unwrap();
    assert!(killed.success());
    assert_eq!(first.wait().unwrap().code(), Some(143));
    assert!(!folder.path().join("o/hard_area/row.txt").exists());
    // A survey that was killed leaves its lock.
    fs::write(folder.path().join("o/adapter.lock"), "99999999\n").unwrap();
    fs::write(&end, "exit 0").unwrap();
    let (code, output) = again();
    assert!(code == Some(0) && output.contains("done after"), "{output}");
    assert!(!folder.path().join("o/adapter.lock").exists());
}

#[test]
fn what_cannot_be_asked_is_told() {
    let folder = tempfile::tempdir().unwrap();
    for (line, code, words) in [
        ("--small --only hardd", 2, "hard_area"),
        ("--adapter nothing-like-it", 3, "nothing-like-it"),
        ("--minutes=0", 2, "1 to 1440"),
        ("--fast", 2, "--fast"),
    ] {
        let (ended, output) = survey(folder.path(), line);
        assert_eq!(ended, Some(code), "{line}: {output}");
        assert!(output.contains(words), "{line}: {output}");
    }
}
