//! `skiagraph judge` and `skiagraph truth`: pictures of other renderers, from the command line.

use crate::support::skiagraph;
use serde_json::Value;
use std::{fs, path::Path, process::Command};

/// The output of a command that succeeds.
fn said(folder: &Path, line: &str) -> String {
    let output = skiagraph(folder, line);
    let stderr = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{line}: {stderr}");
    String::from_utf8(output.stdout).unwrap()
}

/// The message of a command that ends with this exit code.
fn refused(folder: &Path, line: &str, code: i32) -> String {
    let output = skiagraph(folder, line);
    let stderr = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(code), "{line}: {stderr}");
    stderr
}

#[test]
fn a_saved_picture_is_judged_with_the_truth_of_another_command() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    said(
        folder,
        "run nsm --scene park --size 64x48 --map-size 512 --save visibility=nsm.png",
    );
    let truth = said(folder, "truth --scene park --size 64x48 --out truth");
    for file in [
        "visibility.exr",
        "ids.exr",
        "depth.exr",
        "blockers.exr",
        "camera.json",
    ] {
        assert!(
            truth.contains(file) && folder.join("truth").join(file).exists(),
            "{truth}"
        );
    }
    let table = said(
        folder,
        "judge nsm.png truth/visibility.exr --scene park --out judged",
    );
    for part in ["unattributable", "nsm.png (PNG, 8 bits, grey): ", "rank"] {
        assert!(table.contains(part), "{part}: {table}");
    }
    assert!(folder.join("judged/nsm-error.png").exists());
    let kept = fs::read_to_string(folder.join("judged/judge.json")).unwrap();
    let kept: Value = serde_json::from_str(&kept).unwrap();
    let line = "judge nsm.png truth/visibility.exr --ids truth/ids.exr --format json";
    let printed: Value = serde_json::from_str(&said(folder, line)).unwrap();
    assert_eq!(printed["pictures"][1]["wrong"]["total"], 0);
    assert_eq!(printed["unattributable"], 0);
    for field in ["lit", "shadow", "total", "in_band"] {
        let wrong = |record: &Value| record["pictures"][0]["wrong"][field].clone();
        assert_eq!(wrong(&kept), wrong(&printed), "{field}");
    }
    let gate = |condition: &str, code: i32| {
        let output = Command::new(env!("CARGO_BIN_EXE_skiagraph"))
            .args([
                "judge",
                "nsm.png",
                "--ids",
                "truth/ids.exr",
                "--fail-if",
                condition,
            ])
            .current_dir(folder)
            .output()
            .unwrap();
        let stderr = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(code), "{condition}: {stderr}");
        stderr
    };
    let stderr = gate("nsm: wrong > 0.01%", 4);
    assert!(
        stderr.contains("`nsm.png`: wrong ") && stderr.contains("is more than 0.0100 %"),
        "{stderr}"
    );
    gate("nsm.png: wrong > 60%", 0);
    assert!(gate("nsn: wrong > 1%", 1).contains("did you mean"));
    assert!(gate("nsm: frame > 1ms", 1).contains("a picture has no frame"));
}

#[test]
fn mistakes_of_the_command_line_are_told() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    fs::write(folder.join("a.png"), "no picture").unwrap();
    for (line, code, expected) in [
        (
            "judge a.png --scene park",
            1,
            "its first bytes are not those of a picture",
        ),
        ("judge b.png --scene park", 1, "b.png: "),
        (
            "judge a.png --view all",
            2,
            "a picture is of one view under one light",
        ),
        (
            "judge a.png --ids b.npy --depth c.npy",
            2,
            "cannot be used with",
        ),
        (
            "judge a.png --read-as sideways",
            2,
            "expected flipped, srgb or inverted",
        ),
        ("judge", 2, "PICTURE"),
        ("truth --scene park", 2, "--out"),
    ] {
        let message = refused(folder, line, code);
        assert!(message.contains(expected), "{line}: {message}");
    }
}

/// A picture without a number where it counts says so, and no other camera is advised.
#[test]
fn a_picture_without_numbers_holds_no_answer() {
    let folder = tempfile::tempdir().unwrap();
    let files = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/it/judge"));
    for name in ["allnan.exr", "plain.gltf"] {
        fs::copy(files.join(name), folder.path().join(name)).unwrap();
    }
    let line = "judge allnan.exr --scene plain.gltf --eye 6,6,6 --look -1,-0.9,-1 --fov 50 \
                --light -0.6,-1,-0.2";
    let stdout = said(folder.path(), line);
    assert!(stdout.contains("the picture holds no answer"), "{stdout}");
    assert!(stdout.contains("1,080"), "{stdout}");
    assert!(
        !stdout.contains("--view") && !stdout.contains("another camera"),
        "{stdout}"
    );
    for figure in ["wrong > 0.1%", "rmse > 0.1", "flip > 0.1"] {
        let mut command = Command::new(env!("CARGO_BIN_EXE_skiagraph"));
        command
            .args(line.split_whitespace())
            .current_dir(folder.path());
        let gate = format!("allnan: {figure}");
        let output = command.args(["--fail-if", &gate]).output().unwrap();
        let stderr = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(4), "{stderr}");
        assert!(stderr.contains("no finite number at 100.000 %"), "{stderr}");
    }
}
