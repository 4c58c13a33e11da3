//! Every frame of a camera path, judged.

use crate::support::{NOWHERE, along, count, park_comparison, runs, timed};

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
        assert!(jittered["sequence"]["every_pass"].is_null());
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
            // The passes that draw the mesh run while it moves, and no longer.
            for (index, frame) in frames.iter().enumerate() {
                let skipped = frame["skipped"].to_string();
                let expected = match run["preset"].as_str() {
                    Some("nsm") => "create_shadow_map.draw[0]",
                    Some("crsm") => "create_shadow_map.layer[0].turn[0].select",
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
