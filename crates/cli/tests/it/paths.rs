//! `compare --path`: every frame of a camera path, judged. Needs an adapter.

use crate::support::results;
use serde_json::Value;
use std::fs;

fn count(value: &Value) -> u64 {
    value
        .as_u64()
        .unwrap_or_else(|| panic!("{value} is not a count"))
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
    let line = "compare pcf nsm --path all --size 32x32 --map-size 32 --warmup 0 --regime-frames 0 \
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
        let error = |frame: &Value| frame["graded"]["rmse"].as_f64().unwrap();
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
        let (graded, expected) = (graded.as_f64().unwrap(), outside_band(frames));
        assert!((graded - expected).abs() < 0.01, "{name}: {graded}");
        assert!(graded > 0.1 && in_csv.parse::<f64>().unwrap() > 0.1);
        let rmse: f64 = cells[column("worst_frame_rmse")].parse().unwrap();
        assert!((rmse - error(&frames[worst])).abs() < 1e-8, "{name}");
        let images = run["images"].as_object().unwrap();
        assert_eq!(count(&images["frame"]), worst as u64, "{name}");
        let second = images["worst_second"].as_array().unwrap();
        assert!((9..=10).contains(&second.len()), "{name}: {second:?}");
        for file in second {
            let file = file.as_str().unwrap();
            assert!(folder.path().join("out").join(file).is_file(), "{file}");
        }
        let single = |(kind, _): &(&String, &Value)| !["frame", "worst_second"].contains(&&***kind);
        for (kind, file) in images.iter().filter(single) {
            let file = file.as_str().unwrap();
            assert!(file.ends_with(&format!(".{worst:04}.png")), "{name} {kind}");
            assert!(folder.path().join("out").join(file).is_file(), "{file}");
        }
    }
    // Four paths of 9 to 25 frames: what is said of a run names its path.
    for part in ["medians of 9 to 25 frames", "shimmer", "worst"] {
        assert!(table.contains(part), "{part}: {table}");
    }
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
    assert!(page.contains("walk: nsm 32: slowest frame"));
    assert!(page.contains("\"label\":null"), "the reference");
}
