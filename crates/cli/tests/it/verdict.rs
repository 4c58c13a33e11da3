//! The answer of `compare` as its user reads it.

use crate::support::skiagraph;
use std::{fmt::Write, fs, path::Path};

/// A floor under a crown of leaves that are doubled back to back.
fn doubled_tree(file: &Path) {
    let mut obj = String::new();
    let quad = |obj: &mut String, corners: [[f64; 3]; 4]| {
        for [x, y, z] in corners {
            writeln!(obj, "v {x} {y} {z}").unwrap();
        }
        obj.push_str("f -4 -3 -2\nf -4 -2 -1\n");
    };
    quad(
        &mut obj,
        [
            [-4.0, 0.0, 4.0],
            [4.0, 0.0, 4.0],
            [4.0, 0.0, -4.0],
            [-4.0, 0.0, -4.0],
        ],
    );
    for leaf in 0..200 {
        let turn = f64::from(leaf) * 2.4;
        let [x, y, z] = [
            1.5 * turn.cos(),
            1.0 + f64::from(leaf) * 0.015,
            1.5 * turn.sin(),
        ];
        let [a, b] = [0.35 * (turn * 1.7).cos(), 0.35 * (turn * 1.7).sin()];
        let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
        let corners = corners.map(|[s, t]| {
            [
                x + s * a - t * b,
                y + 0.2 * s * t + 0.1 * t,
                z + s * b + t * a,
            ]
        });
        quad(&mut obj, corners);
        obj.push_str("f -2 -3 -4\nf -1 -2 -4\n");
    }
    fs::write(file, obj).unwrap();
}

/// Nothing is exact where most of what is seen has no right answer, and a winner has a condition.
#[test]
fn a_doubled_tree_has_no_exact_method_and_no_winner_without_its_condition() {
    let folder = tempfile::tempdir().unwrap();
    doubled_tree(&folder.path().join("tree.obj"));
    let line = "compare nsm light_buffer rt --scene tree.obj --size 96x96 --map-size 256 \
                --frames 8 --warmup 0 --images none --out out";
    let output = skiagraph(folder.path(), line);
    let stdout = String::from_utf8_lossy(&output.stdout);
    let (_, answer) = stdout.rsplit_once("\n\n").unwrap();
    assert!(!answer.contains("exact"), "{answer}");
    let software = "The adapter is software: its times say nothing about a GPU.\n";
    let answer = answer.strip_prefix(software).unwrap_or(answer);
    let page = fs::read_to_string(folder.path().join("out/report.html")).unwrap();
    // One for all that may move, or several: as times are, of which two are close here.
    let is_winner = |line: &&str| !line.contains("hangs on rounding");
    let winners: Vec<&str> = answer.trim().lines().take_while(is_winner).collect();
    assert!(!winners.is_empty() && winners.len() < 5, "{answer}");
    for sentence in winners {
        assert!(sentence.starts_with("Of the "), "{answer}");
        let condition = sentence.split_once(" that can be judged, wh");
        assert!(
            condition.is_some_and(|(_, rest)| rest.contains(": take `")),
            "{answer}"
        );
        assert!(
            page.contains(&sentence.replace('<', "\\u003c")),
            "the page says the same"
        );
    }
}

#[test]
fn budgets_and_gates_are_held() {
    let folder = tempfile::tempdir().unwrap();
    let line = |rest: &str| {
        format!(
            "compare nsm light_buffer --scene park --size 48x48 --map-size 32 --frames 1 \
             --warmup 0 --images none --out out {rest}"
        )
    };
    let output = skiagraph(folder.path(), &line("--below 0.001% --under 1000000ms"));
    let stdout = String::from_utf8_lossy(&output.stdout);
    assert!(output.status.success(), "{stdout}");
    let within = "Within at most 1000000 ms a frame and less than 0.001 % wrong: 1 of 2 methods.";
    assert!(
        stdout.contains(within) && stdout.contains("take `light_buffer 32` (exact here"),
        "{stdout}"
    );
    let output = skiagraph(folder.path(), &line("--memory 1KiB"));
    let stdout = String::from_utf8_lossy(&output.stdout);
    assert!(
        stdout.contains("no method keeps to at most 1.0 KiB; the smallest is `nsm 32`"),
        "{stdout}"
    );

    let gated = |gate: &str| {
        let mut command = std::process::Command::new(env!("CARGO_BIN_EXE_skiagraph"));
        let line = line("");
        let output = command
            .current_dir(folder.path())
            .args(line.split_whitespace());
        let output = output.args(["--fail-if", gate]).output().unwrap();
        (
            output.status.code(),
            String::from_utf8_lossy(&output.stderr).into_owned(),
        )
    };
    let (code, stderr) = gated("nsm: wrong > 0.1%");
    assert_eq!(code, Some(4), "{stderr}");
    assert!(
        stderr.contains("`nsm 32` at 48x48: wrong ") && stderr.contains("is more than 0.1000 %")
    );
    assert_eq!(gated("light_buffer: wrong > 0.1%").0, Some(0));
    let (code, stderr) = gated("nms: wrong > 0.1%");
    assert_eq!(code, Some(1));
    let parts = [
        "--fail-if: `nms` is not compared",
        "did you mean `nsm`?",
        "methods: nsm",
    ];
    assert!(parts.iter().all(|part| stderr.contains(part)), "{stderr}");
}
