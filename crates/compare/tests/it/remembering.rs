//! A method that traces a quarter of its pixels in each frame and keeps the answers of the frame
//! before for the others.

use crate::support::{TEMPORAL, along, park_comparison, runs, timed};
use serde_json::Value;
use skiagraph_compare::comparison::Comparison;
use std::path::Path;

/// Figures that must not depend on how much is timed.
fn figures(comparison: Comparison, frames: [u32; 3]) -> Value {
    let mut runs = runs(&timed(comparison, frames));
    let run = &mut runs[0];
    let mut frames = run["sequence"]["frames"].take();
    for frame in frames.as_array_mut().into_iter().flatten() {
        for time in ["gpu_ms", "cpu_ms", "wall_ms", "remade"] {
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
    serde_json::json!([kept, frames])
}

#[test]
#[ignore = "a suite: `./test.sh --all` runs it"]
fn it_has_one_figure_whatever_is_timed() {
    let still = || park_comparison(&["temporal.ron"], TEMPORAL.as_ref(), 48);
    let subjects: [(&str, &dyn Fn() -> Comparison); 2] =
        [("still", &still), ("walk", &|| along(still(), "walk"))];
    for (name, subject) in subjects {
        let expected = figures(subject(), [0, 1, 0]);
        for (frames, warmup) in [(5, 0), (11, 0), (1, 3), (5, 3), (11, 3)] {
            let measured = figures(subject(), [warmup, frames, frames]);
            assert_eq!(measured, expected, "{name}: {frames} frames after {warmup}");
        }
    }
}

#[test]
fn it_is_right_where_the_camera_stands_and_late_where_it_moves() {
    let compared = || {
        timed(
            park_comparison(&["temporal.ron"], TEMPORAL.as_ref(), 48),
            [2, 1, 1],
        )
    };
    let still = runs(&compared());
    let run = &still[0];
    // Four frames until every pixel had its ray, and those that show it.
    assert_eq!(run["steady"]["period"], 1);
    assert_eq!(run["steady"]["judged"]["pictures"], 1);
    assert!((33..40).contains(&run["steady"]["frames"].as_u64().unwrap()));
    assert_eq!(run["wrong"]["total"], run["wrong"]["in_band"]);
    let begin = run["steady"]["begin"].as_array().unwrap();
    let frames = begin
        .iter()
        .map(|picture| picture["frames"].as_u64().unwrap());
    assert_eq!(frames.collect::<Vec<_>>(), [1, 4, 16]);
    let wrong = begin.iter().map(|picture| &picture["wrong_outside_band"]);
    let wrong: Vec<u64> = wrong.map(|wrong| wrong.as_u64().unwrap()).collect();
    assert!(wrong[0] > 0 && wrong[1..] == [0, 0], "{wrong:?}");

    let moving = runs(&along(compared(), "walk"));
    let frames = moving[0]["sequence"]["frames"].as_array().unwrap();
    assert_eq!(frames[0]["wrong_outside_band"], 0);
    let late = |frame: &&Value| frame["wrong_outside_band"].as_u64().unwrap() > 0;
    assert!(frames.iter().filter(late).count() > 12, "{frames:?}");
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
    let runs = runs(&timed(
        park_comparison(&["blink.ron"], folder, 48),
        [2, 1, 1],
    ));
    let run = &runs[0];
    let [lit, shadow] = ["lit", "shadow"].map(|name| run["pixels"][name].as_u64().unwrap());
    assert!(lit > 0 && shadow > 0);
    assert_eq!(run["steady"]["period"], 3);
    assert_eq!(run["wrong"]["total"], lit.max(shadow));
    let mean = (2 * lit + shadow) as f64 / 3.0;
    let wrong_mean = run["steady"]["judged"]["wrong_mean"].as_f64().unwrap();
    assert!((wrong_mean - mean).abs() < 1e-6, "{wrong_mean} for {mean}");
}
