//! `compare` of a method that traces a quarter of its pixels in each frame and keeps the answers of
//! the frame before for the others. Needs an adapter.

use crate::support::{results, skiagraph, temporal};
use serde_json::Value;
use std::path::Path;

/// Figures that must not depend on how much is timed.
fn figures(folder: &Path, line: &str) -> (Value, String) {
    let line =
        format!("compare temporal.ron --size 48x48 --images none --replace --out out {line}");
    let (mut runs, table) = results(folder, &line);
    let run = &mut runs[0];
    let mut frames = run["sequence"]["frames"].take();
    for frame in frames.as_array_mut().into_iter().flatten() {
        for time in ["gpu_ms", "wall_ms", "every_pass", "remade"] {
            frame.as_object_mut().unwrap().remove(time);
        }
    }
    let kept = [
        "pixels",
        "band",
        "wrong",
        "split",
        "uncertain",
        "rays",
        "steady",
    ];
    let kept = kept.map(|name| run[name].take());
    (serde_json::json!([kept, frames]), table)
}

#[test]
#[ignore = "a suite: `./test.sh --all` runs it"]
fn it_has_one_figure_whatever_is_timed() {
    let folder = tempfile::tempdir().unwrap();
    temporal(folder.path());
    for subject in ["", "--path walk"] {
        let figures = |flags: &str| figures(folder.path(), &format!("{subject} {flags}"));
        let (expected, table) = figures("--frames 1 --warmup 0 --cached-frames 0");
        assert!(table.contains("temporal.ron remembers"), "{table}");
        for flags in [
            "--frames 5 --warmup 0",
            "--frames 11 --warmup 0",
            "--frames 1 --warmup 3",
            "--frames 5 --warmup 3",
            "--frames 11 --warmup 3",
        ] {
            assert_eq!(figures(flags).0, expected, "{subject} {flags}");
        }
    }
}

/// Documents that count frames: by the graph's number of them, or by a buffer that stays.
const COUNTERS: [[&str; 3]; 2] = [
    [
        "",
        "",
        "#import \"shared/frame.wgsl\"\nfn count() -> u32 { return frame.index; }",
    ],
    [
        r#"Buffer(name: "counter", keep: true),"#,
        r#"Compute(name: "count_up", dispatch: Groups(1, 1, 1)),"#,
        "var<storage, read> counter: u32; fn count() -> u32 { return counter; }",
    ],
];

#[test]
fn a_picture_that_cycles_is_judged_by_its_worst_and_its_mean() {
    for [material, pass, count] in COUNTERS {
        let folder = tempfile::tempdir().unwrap();
        let write = |name: &str, text: String| {
            std::fs::write(folder.path().join(name), text).unwrap();
        };
        write(
            "blink.ron",
            format!(
                r#"(
            format: 3,
            description: "All in shadow in two frames of three, and all in light in the third.",
            materials: [{material} Texture(name: "visibility", format: R32Uint)],
            passes: [Fullscreen(name: "blink", color: ["visibility"]), {pass}],
            outputs: ["visibility"],
        )"#
            ),
        );
        write(
            "blink.wgsl",
            format!(
                "{count}
                @fragment fn fragment() -> @location(0) u32 {{ return u32(count() % 3u == 0u); }}"
            ),
        );
        write(
            "count_up.wgsl",
            "var<storage, read_write> counter: u32;
            @compute @workgroup_size(1) fn main() { counter++; }"
                .to_owned(),
        );
        blinks(folder.path());
    }
}

fn blinks(folder: &Path) {
    let line = "compare blink.ron --size 48x48 --images none --frames 1 --out out";
    let (runs, table) = results(folder, line);
    let run = &runs[0];
    let [lit, shadow] = ["lit", "shadow"].map(|name| run["pixels"][name].as_u64().unwrap());
    assert!(lit > 0 && shadow > 0);
    assert_eq!(run["steady"]["period"], 3);
    assert_eq!(run["wrong"]["total"], lit.max(shadow));
    let mean = (2 * lit + shadow) as f64 / 3.0;
    let found = run["steady"]["judged"]["wrong_mean"].as_f64().unwrap();
    assert!((found - mean).abs() < 1e-6, "{found} for {mean}");
    assert!(table.contains("repeats every 3 frames"), "{table}");
}

#[test]
fn stress_judges_its_steady_state_too() {
    let folder = tempfile::tempdir().unwrap();
    temporal(folder.path());
    let line = "stress temporal.ron --exact temporal.ron --case box_on_floor --size 48x48";
    let output = skiagraph(folder.path(), line);
    let told = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{told}");
}
