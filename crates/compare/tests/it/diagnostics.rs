//! Outputs on request that tell of a shadow map.

use crate::support::{
    Heard, LIT, NOWHERE, along, comparison, count, gpu, keep, mesh, park, park_comparison, runs,
};
use glam::DVec3;
use serde_json::Value;
use skiagraph_compare::{
    measuring::{resume::Kept, series},
    sink::Session,
};
use skiagraph_gpu::block_on;
use skiagraph_scene::{DirectionalLight, View};
use std::fs;

/// Names of the passes of a run that were timed.
fn passes(run: &Value) -> Vec<&str> {
    let passes = run["passes"].as_array().unwrap();
    passes
        .iter()
        .map(|pass| pass["name"].as_str().unwrap())
        .collect()
}

/// From 10 above it, 64 pixels at 90° see 20 units of the floor, and the map of 256 texels lies
/// over all 40: everywhere two by two texels.
#[test]
fn texels_per_pixel_of_a_floor_are_those_worked_by_hand() {
    let folder = tempfile::tempdir().unwrap();
    let floor = "v -20 0 -20\nv 20 0 -20\nv 20 0 20\nv -20 0 20\nf 4 3 2 1\n";
    let view = View {
        eye: DVec3::new(0.0, 10.0, 0.0),
        direction: DVec3::NEG_Y,
        up: DVec3::Z,
        fov_y_degrees: 90.0,
        far: 100.0,
        ..View::default()
    };
    let light = DirectionalLight::new(DVec3::NEG_Y);
    let scene = mesh(folder.path(), floor, view, light);
    let mut comparison = comparison(scene, &["nsm"], NOWHERE.as_ref(), &[256]);
    comparison.viewports = vec![[64, 64]];
    let run = &runs(&comparison)[0];
    let texels = &run["texels"];
    assert_eq!(count(&texels["pixels"]), 64 * 64, "{texels}");
    assert_eq!(
        (&texels["under_one"], &texels["outside_map"]),
        (&0.into(), &0.into()),
        "{texels}"
    );
    let is_near =
        |value: &Value, expected: f64| (value.as_f64().unwrap() / expected - 1.0).abs() < 0.02;
    for quantile in ["p5", "median", "p95"] {
        assert!(is_near(&texels["texels"][quantile], 4.0), "{texels}");
    }
    // At the edges the eye leans and the light does not: fewer texels on what faces both.
    assert!(
        texels["projection"]["p95"].as_f64().unwrap() > 1.2,
        "{texels}"
    );
    assert!(
        texels["perspective"]["p5"].as_f64().unwrap() < 3.4,
        "{texels}"
    );
    assert_eq!(run["layer_jump"], Value::Null);
}

#[test]
fn a_map_is_asked_after_the_timed_frames_and_pictured() {
    let folder = tempfile::tempdir().unwrap();
    let mut comparison = park_comparison(&["nsm", "pssm", "rt"], NOWHERE.as_ref(), 64);
    comparison.protocol.pictures = true;
    let (_, results) = keep(&comparison, folder.path(), Kept::Others).unwrap();
    let [nsm, pssm, rt] = &results["runs"].as_array().unwrap()[..] else {
        panic!("{results}")
    };
    for run in [nsm, pssm, rt] {
        let timed = passes(run);
        assert!(
            !timed.iter().any(|pass| pass.contains("texel_density")),
            "{timed:?}"
        );
    }
    for run in [nsm, pssm] {
        let facing = count(&run["pixels"]["facing_light"]);
        let [inside, outside] = ["pixels", "outside_map"].map(|key| count(&run["texels"][key]));
        assert_eq!(inside + outside, facing);
        for kind in ["texels", "perspective", "projection"] {
            let picture = folder.path().join(run["images"][kind].as_str().unwrap());
            let picture = image::open(picture).unwrap().to_rgb8();
            assert_eq!(picture.dimensions(), (64, 64), "{kind}");
        }
    }
    // Splits spend the texels where the eye is: in the median far more of them.
    let median = |run: &Value| run["texels"]["perspective"]["median"].as_f64().unwrap();
    assert!(
        median(pssm) > 4.0 * median(nsm),
        "{} {}",
        median(nsm),
        median(pssm)
    );
    let jump = &pssm["layer_jump"];
    assert!(count(&jump["pairs"]) > 20, "{jump}");
    assert!(
        count(&jump["pairs_elsewhere"]) > 50 * count(&jump["pairs"]),
        "{jump}"
    );
    assert_eq!(nsm["layer_jump"], Value::Null);
    for key in ["texels", "layer_jump"] {
        assert_eq!(rt[key], Value::Null);
    }
    assert_eq!(rt["images"]["texels"], Value::Null);
    let mut table = csv::Reader::from_path(folder.path().join("results.csv")).unwrap();
    let heads = table.headers().unwrap().clone();
    let place = |name| heads.iter().position(|head| head == name).unwrap();
    let mut columns = place("texel_pixels")..=place("layer_jump");
    assert_eq!(columns.clone().count(), 16);
    let of_rt = table.records().nth(2).unwrap().unwrap();
    assert!(columns.all(|column| of_rt[column].is_empty()), "{of_rt:?}");
}

#[test]
fn a_paths_worst_frame_is_asked() {
    let mut comparison = comparison(park(), &["pssm"], NOWHERE.as_ref(), &[64]);
    comparison.viewports = vec![[32, 32]];
    let run = &runs(&along(comparison, "walk"))[0];
    assert!(count(&run["texels"]["pixels"]) > 0, "{run}");
}

#[test]
fn diagnostics_of_another_format_are_told_and_left_out() {
    let folder = tempfile::tempdir().unwrap();
    let odd = LIT.replace(
        r#"outputs: ["visibility", "status"]"#,
        r#"outputs: ["visibility", "status",
            (name: "texel_density", material: "status", on_request: true),
            (name: "map_layer", material: "status", on_request: true)]"#,
    );
    assert_ne!(odd, LIT);
    fs::write(folder.path().join("odd.ron"), odd).unwrap();
    let comparison = park_comparison(&["odd.ron"], folder.path(), 16);
    let heard = Heard::default();
    comparison.check(Session::new(gpu(), &heard)).unwrap();
    let notes = heard.notes();
    for part in [
        "`odd.ron`: the output `texel_density` is R8Uint of 16x16",
        "expected R32Float",
    ] {
        assert!(notes.contains(part), "{notes}");
    }
    // It is measured, and behind the results an error.
    let error = block_on(series::run(&comparison, Session::new(gpu(), &heard))).unwrap_err();
    assert!(error.to_string().contains("expected R32Float"), "{error}");
}
