//! `compare --path`: every frame of a camera path, judged. Needs an adapter.

use crate::support::{results, skiagraph};
use serde_json::Value;
use std::fs;

fn count(value: &Value) -> u64 {
    value
        .as_u64()
        .unwrap_or_else(|| panic!("{value} is not a count"))
}

#[test]
fn every_frame_is_judged_and_exact_methods_do_not_shimmer() {
    let folder = tempfile::tempdir().unwrap();
    let line = "compare rt nsm light_buffer --path walk --size 64x64 --map-size 128 --warmup 1 \
                --out out";
    let (runs, table) = results(folder.path(), line);
    assert_eq!(runs.len(), 3);
    for heading in ["path walk", "25 frames", "shimmer", "worst frame"] {
        assert!(table.contains(heading), "{heading}: {table}");
    }
    for run in &runs {
        let sequence = &run["sequence"];
        let frames = sequence["frames"].as_array().unwrap();
        assert_eq!(frames.len(), 25);
        let sum = |name: &str| -> u64 { frames.iter().map(|frame| count(&frame[name])).sum() };
        assert_eq!(sum("facing_light"), count(&run["pixels"]["facing_light"]));
        assert_eq!(sum("wrong"), count(&run["wrong"]["total"]));
        assert!(frames[0]["shimmer"].is_null());
        let changed: u64 = frames[1..]
            .iter()
            .map(|frame| count(&frame["shimmer"]["changed"]))
            .sum();
        let shimmer = &sequence["shimmer"];
        assert_eq!(changed, count(&shimmer["changed"]));
        let seen_twice = count(&shimmer["compared"]) as f64 / sum("facing_light") as f64;
        assert!((0.4..0.96).contains(&seen_twice), "{shimmer}");
        if run["preset"] == "nsm" {
            assert!(
                changed > 200 && sum("wrong_outside_band") > 2_000,
                "{shimmer}"
            );
            let skipped = frames[5]["skipped"].to_string();
            assert!(skipped.contains("create_shadow_map.draw[0]"), "{skipped}");
            for frame in frames {
                let wall = frame["every_pass"]["wall_ms"].as_f64();
                assert!(wall.is_some_and(|ms| ms > 0.0), "{frame}");
            }
            assert!(sequence["every_pass"]["wall_ms"]["median"].is_f64());
            for line in ["as it is: slowest frame", "with every pass: slowest frame"] {
                assert!(
                    table.contains(&format!("nsm 128 {line}")),
                    "{line}: {table}"
                );
            }
        } else {
            assert_eq!(
                (changed, sum("wrong_outside_band")),
                (0, 0),
                "{}",
                run["preset"]
            );
        }
    }
    let csv = fs::read_to_string(folder.path().join("out/results.csv")).unwrap();
    let head = csv.lines().next().unwrap();
    assert!(head.contains(",worst_frame,worst_frame_wrong,"), "{head}");
    assert!(
        head.contains(",slowest_frame,slowest_frame_ms,every_pass_gpu_ms,"),
        "{head}"
    );

    let kept = skiagraph(folder.path(), &format!("{line} --resume"));
    let told = String::from_utf8_lossy(&kept.stderr);
    assert!(told.contains("3 of 3 runs are kept"), "{told}");
}

#[test]
fn a_part_that_is_not_there_is_refused_with_those_that_are() {
    let folder = tempfile::tempdir().unwrap();
    let scene = r#"(
        format: 1, name: "own", mesh: Generated("park"), light: (direction: (0.7, -0.4, 0.5)),
        views: [(
            name: "v", eye: (-10, 60, 60), direction: (0.5, -0.7, -0.6), fov_y_degrees: 60,
            near: 1, far: 400,
        )],
        paths: [(
            name: "p", fov_y_degrees: 60, near: 1, far: 400,
            keys: [
                (at: 0, eye: (-10, 60, 60), direction: (0.5, -0.7, -0.6)),
                (at: 0.1, eye: (-10, 60, 60), direction: (0.5, -0.7, -0.6)),
            ],
            moves: [Sway(part: "tree 9", axis: (1, 0, 0), degrees: 5, seconds: 2)],
        )],
    )"#;
    fs::write(folder.path().join("own.ron"), scene).unwrap();
    let output = skiagraph(folder.path(), "compare nsm --scene own.ron --path p");
    assert_eq!(output.status.code(), Some(1));
    let told = String::from_utf8_lossy(&output.stderr);
    assert!(
        told.contains("path \"p\": moves: no part of the mesh is called \"tree 9\"; known here:")
            && told.contains("tree 1"),
        "{told}"
    );
}

#[test]
fn a_path_that_is_not_there_is_refused_with_those_that_are() {
    let folder = tempfile::tempdir().unwrap();
    let refused = |line: &str| {
        let output = skiagraph(folder.path(), line);
        assert_eq!(output.status.code(), Some(1), "{line}");
        String::from_utf8_lossy(&output.stderr).into_owned()
    };
    let unknown = refused("compare nsm --path wlak");
    assert!(
        unknown.contains("`park` has no path `wlak`; did you mean `walk`?")
            && unknown.contains("paths: walk, sunrise, lamp, wind, or all of them: all"),
        "{unknown}"
    );
    let none = refused("compare nsm --scene city:20000 --path walk");
    assert!(
        none.contains("`city` has no camera paths") && none.contains("keys:"),
        "{none}"
    );
}

/// The root mean square error outside the band of all frames, from those of each.
fn outside_band(frames: &[Value]) -> f64 {
    let (mut squares, mut pixels) = (0.0, 0.0);
    for frame in frames {
        let rmse = frame["graded"]["rmse_outside_band"].as_f64().unwrap();
        // At this size the band has a handful of pixels.
        let facing = count(&frame["facing_light"]) as f64;
        squares += rmse * rmse * facing;
        pixels += facing;
    }
    (squares / pixels).sqrt()
}

#[test]
#[ignore = "a suite: `./test.sh --all` runs it"]
fn figures_lines_and_pictures_say_of_which_path_and_frame_they_are() {
    let folder = tempfile::tempdir().unwrap();
    let line = "compare pcf nsm --path all --size 32x32 --map-size 32 --warmup 0 --cached-frames 0 \
                --out out";
    let (runs, table) = results(folder.path(), line);
    assert_eq!(runs.len(), 8);
    let csv = fs::read_to_string(folder.path().join("out/results.csv")).unwrap();
    let mut lines = csv::Reader::from_reader(csv.as_bytes());
    let heads = lines.headers().unwrap().clone();
    let column = |name: &str| heads.iter().position(|head| head == name).unwrap();
    for (run, cells) in runs.iter().zip(lines.records()) {
        let cells = cells.unwrap();
        let frames = run["sequence"]["frames"].as_array().unwrap();
        let error = |frame: &Value| match frame["graded"]["rmse"].as_f64() {
            Some(rmse) => rmse,
            None => count(&frame["wrong"]) as f64 / count(&frame["facing_light"]) as f64,
        };
        let worst = (0..frames.len()).fold(0, |worst, index| {
            if error(&frames[index]) > error(&frames[worst]) {
                index
            } else {
                worst
            }
        });
        let name = format!("{} on {}", run["preset"], run["view"]);
        assert_eq!(cells[column("worst_frame")], worst.to_string(), "{name}");
        let graded = &run["graded"]["rmse_outside_band"];
        let in_csv = &cells[column("rmse_outside_band")];
        if run["preset"] == "pcf" {
            let (graded, expected) = (graded.as_f64().unwrap(), outside_band(frames));
            assert!((graded - expected).abs() < 0.01, "{name}: {graded}");
            assert!(graded > 0.1 && in_csv.parse::<f64>().unwrap() > 0.1);
            let rmse: f64 = cells[column("worst_frame_rmse")].parse().unwrap();
            assert!((rmse - error(&frames[worst])).abs() < 1e-8, "{name}");
        } else {
            assert!(graded.is_null() && in_csv.is_empty(), "{name}")
        }
        let images = run["images"].as_object().unwrap();
        assert_eq!(count(&images["frame"]), worst as u64, "{name}");
        for (kind, file) in images.iter().filter(|(kind, _)| *kind != "frame") {
            let file = file.as_str().unwrap();
            assert!(file.ends_with(&format!(".{worst:04}.png")), "{name} {kind}");
            assert!(folder.path().join("out").join(file).is_file(), "{file}");
        }
    }
    // Four paths of 9 to 25 frames: what is said of a run names its path.
    assert!(table.contains("medians of 9 to 25 frames"), "{table}");
    let of_runs = table
        .lines()
        .filter(|line| line.contains("slowest frame") || line.contains("between frames"));
    let of_runs: Vec<&str> = of_runs.collect();
    assert!(of_runs.len() >= 8, "{table}");
    for line in of_runs {
        let is_named = ["walk: ", "sunrise: ", "lamp: ", "wind: "]
            .iter()
            .any(|path| line.starts_with(path));
        assert!(is_named, "{line}");
    }
    let page = fs::read_to_string(folder.path().join("out/report.html")).unwrap();
    assert!(page.contains("walk: nsm 32 as it is: slowest frame"));
    assert!(page.contains("\"label\":null,\"frame\":"), "the reference");
}
