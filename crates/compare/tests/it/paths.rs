//! Every frame of a camera path, judged.

use crate::support::{NOWHERE, along, count, keep, park, park_comparison, runs, scene, timed};
use skiagraph_compare::measuring::{
    frame_sequence::FrameSequence, resume::Kept, view_or_path::ViewOrPath,
};
use skiagraph_scene::SceneLibrary;
use std::fs;

#[test]
#[ignore = "a suite: `./test.sh --all` runs it"]
fn a_moving_light_is_followed_by_what_is_kept_and_by_the_reference() {
    let comparison = park_comparison(&["rt", "light_buffer", "nsm"], NOWHERE.as_ref(), 64);
    let runs = runs(&timed(along(comparison, "sunrise"), [1, 10, 10]));
    assert_eq!(runs.len(), 3);
    for run in &runs {
        let frames = run["sequence"]["frames"].as_array().unwrap();
        assert_eq!(frames.len(), 17);
        let facing: Vec<u64> = frames.iter().map(|it| count(&it["facing_light"])).collect();
        assert!(facing[0] > 500 && facing[0] != facing[14], "{facing:?}");
        if run["preset"] != "nsm" {
            let wrong = frames.iter().map(|it| count(&it["wrong_outside_band"]));
            assert_eq!(wrong.sum::<u64>(), 0, "{}", run["preset"]);
            continue;
        }
        // The map is drawn while the light moves, and kept in the two frames in which it stands.
        for (index, frame) in frames.iter().enumerate() {
            let skipped = frame["skipped"].to_string();
            let is_kept = skipped.contains("create_shadow_map.draw[0]");
            assert_eq!(is_kept, index == 0 || index > 14, "{index}: {skipped}");
        }
    }
}

#[test]
#[ignore = "a suite: `./test.sh --all` runs it"]
fn a_jittered_camera_is_followed_by_gbuffer_and_reference() {
    let comparison = park_comparison(&["rt", "light_buffer"], NOWHERE.as_ref(), 64);
    let mut comparison = timed(along(comparison, "walk"), [0, 10, 0]);
    let plain = runs(&comparison);
    comparison.protocol.jitter = Some(8);
    let jittered = runs(&comparison);
    assert_eq!((plain.len(), jittered.len()), (2, 2));
    for (plain, jittered) in plain.iter().zip(&jittered) {
        assert_ne!(plain["pixels"], jittered["pixels"]);
        assert_ne!(plain["fingerprint"], jittered["fingerprint"]);
        let wrong = &jittered["wrong"];
        assert_eq!(wrong["total"], wrong["in_band"], "{}", jittered["preset"]);
        let band =
            count(&jittered["band"]) as f64 / count(&jittered["pixels"]["facing_light"]) as f64;
        assert!(band < 1e-3, "{band}");
    }
}

#[test]
#[ignore = "a suite: `./test.sh --all` runs it"]
fn moving_parts_are_followed_by_what_is_kept_and_by_the_reference() {
    // From frame to frame the lamp moves until the seventh, the tree always.
    for (path, standing) in [("lamp", 7), ("wind", 9)] {
        let methods = ["rt", "light_buffer", "nsm", "crsm"];
        let comparison = park_comparison(&methods, NOWHERE.as_ref(), 64);
        let runs = runs(&timed(along(comparison, path), [1, 10, 10]));
        assert_eq!(runs.len(), 4);
        for run in &runs {
            let frames = run["sequence"]["frames"].as_array().unwrap();
            assert_eq!(frames.len(), 9);
            let facing: Vec<u64> = frames.iter().map(|it| count(&it["facing_light"])).collect();
            assert!(facing[0] > 500, "{facing:?}");
            let shimmer = &run["sequence"]["shimmer"];
            assert!(count(&shimmer["compared"]) > 2_000, "{shimmer}");
            if run["preset"] != "nsm" {
                let wrong = frames.iter().map(|it| count(&it["wrong_outside_band"]));
                let wrong: Vec<u64> = wrong.collect();
                assert_eq!(wrong, [0; 9], "{path} {}", run["preset"]);
                assert_eq!(count(&shimmer["changed"]), 0, "{path} {}", run["preset"]);
            }
            let upkeep = |index: usize| {
                let times = &run["regimes"][index];
                let cpu = times["frame"]["cpu_ms"]["median"].as_f64().unwrap();
                (cpu, count(&times["uploaded_bytes"]))
            };
            let [rest, camera, light, some, whole] = [0, 1, 2, 3, 4].map(upkeep);
            assert_eq!(rest.1, 0, "{}", run["preset"]);
            assert!(
                camera.1 > 0 && light.1 > 0,
                "{path} {} {camera:?} {light:?}",
                run["preset"]
            );
            assert!(some.1 > camera.1, "{some:?} {camera:?}");
            // By maps, so that only a hierarchy is brought to the device.
            let has_hierarchy = ["rt", "crsm"].contains(&run["preset"].as_str().unwrap());
            let is_so = if has_hierarchy {
                whole.1 > some.1
            } else {
                whole.1 < 1024
            };
            assert!(is_so, "{path} {} {some:?} {whole:?}", run["preset"]);
            assert!(whole.0 > rest.0, "{rest:?} {whole:?}");
            // The passes that draw the mesh run while it moves, and no longer.
            for (index, frame) in frames.iter().enumerate() {
                let skipped = frame["skipped"].to_string();
                let expected = match run["preset"].as_str() {
                    Some("nsm") => "create_shadow_map.draw[0]",
                    Some("crsm") => "create_shadow_map.layer[0].turn[0].select",
                    Some("light_buffer") => "bin_casters.box_clusters",
                    // They keep nothing: every pass of theirs reads the mesh or the eye.
                    _ => {
                        assert_eq!(skipped, "null", "{path} {}", run["preset"]);
                        continue;
                    }
                };
                let is_kept = skipped.contains(expected);
                assert_eq!(
                    is_kept,
                    index == 0 || index >= standing,
                    "{path} {} {index}: {skipped}",
                    run["preset"]
                );
            }
        }
    }
}

#[test]
fn every_frame_is_judged_and_exact_methods_do_not_shimmer() {
    let out = tempfile::tempdir().unwrap();
    let comparison = park_comparison(&["rt", "nsm", "light_buffer"], NOWHERE.as_ref(), 64);
    let comparison = timed(along(comparison, "walk"), [1, 10, 10]);
    let (_, results) = keep(&comparison, out.path(), Kept::Others).unwrap();
    let runs = results["runs"].as_array().unwrap();
    assert_eq!(runs.len(), 3);
    for run in runs {
        let sequence = &run["sequence"];
        let frames = sequence["frames"].as_array().unwrap();
        assert_eq!(frames.len(), 25);
        let sum = |name: &str| -> u64 { frames.iter().map(|frame| count(&frame[name])).sum() };
        assert_eq!(sum("facing_light"), count(&run["pixels"]["facing_light"]));
        assert_eq!(sum("wrong"), count(&run["wrong"]["total"]));
        assert!(frames[0]["shimmer"].is_null());
        let changed = frames[1..]
            .iter()
            .map(|frame| count(&frame["shimmer"]["changed"]));
        let changed: u64 = changed.sum();
        let shimmer = &sequence["shimmer"];
        assert_eq!(changed, count(&shimmer["changed"]));
        let seen_twice = count(&shimmer["compared"]) as f64 / sum("facing_light") as f64;
        assert!((0.4..0.96).contains(&seen_twice), "{shimmer}");
        let outside = sum("wrong_outside_band");
        if run["preset"] != "nsm" {
            assert_eq!((changed, outside), (0, 0), "{}", run["preset"]);
            continue;
        }
        assert!(changed > 200 && outside > 2_000, "{shimmer}");
        let skipped = frames[5]["skipped"].to_string();
        assert!(skipped.contains("create_shadow_map.draw[0]"), "{skipped}");
        for frame in frames {
            let [cpu, wall] = ["cpu_ms", "wall_ms"].map(|name| frame[name].as_f64().unwrap());
            assert!(cpu > 0.0 && cpu < wall, "{frame}");
        }
        assert!(run["turns"]["anchor"]["cpu_frames"].is_array());
        assert_eq!(run["regimes"].as_array().unwrap().len(), 3);
    }
    let csv = fs::read_to_string(out.path().join("results.csv")).unwrap();
    let head = csv.lines().next().unwrap();
    for columns in [
        ",worst_frame,worst_frame_wrong,",
        ",slowest_frame,slowest_frame_ms,worst_frame_rmse,",
    ] {
        assert!(head.contains(columns), "{head}");
    }
    let (heard, _) = keep(&comparison, out.path(), Kept::All).unwrap();
    let notes = heard.notes();
    assert!(notes.contains("3 of 3 runs are kept"), "{notes}");
}

#[test]
fn a_part_that_is_not_there_is_refused_with_those_that_are() {
    let folder = tempfile::tempdir().unwrap();
    let text = r#"(
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
    let file = folder.path().join("own.ron");
    fs::write(&file, text).unwrap();
    let file = file.to_str().unwrap();
    let (scene, paths) = (scene(file), SceneLibrary::default().paths(file).unwrap());
    let paths = ViewOrPath::paths(&scene, paths, "p", None).unwrap();
    let sequence = FrameSequence::new(&paths[0], &scene, None, Some(2));
    let error = sequence.err().unwrap().to_string();
    assert!(
        error.contains("path \"p\": moves: no part of the mesh is called \"tree 9\"; known here:")
            && error.contains("tree 1"),
        "{error}"
    );
}

#[test]
fn a_path_that_is_not_there_is_refused_with_those_that_are() {
    let paths = SceneLibrary::default().paths("park").unwrap();
    let refused = |paths, name| {
        let refused = ViewOrPath::paths(&park(), paths, name, None);
        refused.err().unwrap().to_string()
    };
    let unknown = refused(paths, "wlak");
    assert!(
        unknown.contains("`park` has no path `wlak`; did you mean `walk`?")
            && unknown.contains("paths: walk, sunrise, lamp, wind, or all of them: all"),
        "{unknown}"
    );
    let none = refused(Vec::new(), "walk");
    assert!(
        none.contains("`park` has no camera paths") && none.contains("keys:"),
        "{none}"
    );
}
