//! Figures of a comparison on a scene: they fit together, and say what is wrong with a method.

use crate::support::{
    LIT, NOWHERE, comparison, count, gpu, keep, mesh, park, park_comparison, runs, timed,
};
use glam::DVec3;
use serde_json::Value;
use skiagraph_compare::{
    comparison::Comparison,
    measuring::{
        device::{self, GpuRequest},
        ground_truth::PrimaryVisibility,
        resume::Kept,
        series,
    },
    sink::{Session, Silent},
};
use skiagraph_gpu::block_on;
use skiagraph_graph::Sources;
use skiagraph_passes::EmbeddedSources;
use skiagraph_reference::OracleMode;
use skiagraph_scene::{DirectionalLight, View};
use std::{fs, path::Path};

fn png(path: &Path) -> image::RgbImage {
    image::open(path)
        .unwrap_or_else(|error| panic!("{}: {error}", path.display()))
        .to_rgb8()
}

/// Why a comparison ends early.
fn refused(comparison: &Comparison) -> String {
    let outcome = block_on(series::run(comparison, Session::new(gpu(), &Silent)));
    outcome.unwrap_err().to_string()
}

#[test]
fn every_run_is_measured_judged_and_pictured() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path();
    let methods = ["rt", "nsm"];
    let comparison = comparison(park(), &methods, NOWHERE.as_ref(), &[64, 256]);
    let mut comparison = timed(comparison, [0, 2, 2]);
    comparison.viewports = vec![[64, 64], [96, 48]];
    comparison.protocol.pictures = true;
    let (_, results) = keep(&comparison, out, Kept::Others).unwrap();
    assert_eq!(results["schema"], 2);
    assert_eq!(results["scene"]["name"], "park");
    let runs = results["runs"].as_array().unwrap();
    assert_eq!(runs.len(), 6, "rt once and nsm twice, on two viewports");
    for run in runs {
        fits_together(run);
        let [width, height] = [0, 1].map(|axis| count(&run["viewport"][axis]) as u32);
        for kind in ["shaded", "visibility", "error", "uncertain"] {
            let picture = png(&out.join(run["images"][kind].as_str().unwrap()));
            assert_eq!(picture.dimensions(), (width, height));
        }
    }
    let purple = |stem: &str| {
        let picture = png(&out.join(format!("{stem}-uncertain.png")));
        let purple = |pixel: &&image::Rgb<u8>| pixel.0 == [160, 32, 240];
        picture.pixels().filter(purple).count() as u64
    };
    assert_eq!(purple("nsm-bench_side-64x64-map64"), 0);
    assert!(purple("rt-bench_side-64x64") >= count(&runs[0]["uncertain"]));
    let runs_of = |preset| runs.iter().filter(move |run| run["preset"] == preset);
    for run in runs_of("rt") {
        assert_eq!(
            count(&run["wrong"]["total"]),
            count(&run["wrong"]["in_band"]),
            "rays are exact outside the band"
        );
        assert_eq!(run["map_size"], Value::Null);
        assert!(count(&run["rays"]) > 0);
    }
    let wrong: Vec<u64> = runs_of("nsm")
        .map(|run| count(&run["wrong"]["total"]))
        .collect();
    assert!(
        wrong[1] < wrong[0],
        "a larger map is wrong less often: {wrong:?}"
    );
    let csv = fs::read_to_string(out.join("results.csv")).unwrap();
    assert_eq!(csv.lines().count(), 7, "a header and a line per run");
    png(&out.join("reference-bench_side-64x64-visibility.png"));
}

/// Counts of a run are parts of a whole; its times are there.
fn fits_together(run: &Value) {
    assert_eq!(run["unavailable"], Value::Null);
    let pixels = &run["pixels"];
    let classes = ["background", "facing_away", "facing_light"].map(|class| count(&pixels[class]));
    let [width, height] = [0, 1].map(|axis| count(&run["viewport"][axis]));
    assert_eq!(classes.iter().sum::<u64>(), width * height);
    assert_eq!(
        count(&pixels["lit"]) + count(&pixels["shadow"]),
        count(&pixels["facing_light"])
    );
    let wrong = &run["wrong"];
    assert_eq!(
        count(&wrong["lit"]) + count(&wrong["shadow"]),
        count(&wrong["total"])
    );
    for class in ["lit", "shadow"] {
        let split = &run["split"][class];
        let counts =
            ["certain_right", "certain_wrong", "uncertain"].map(|word| count(&split[word]));
        assert_eq!(counts.iter().sum::<u64>(), count(&pixels[class]), "{split}");
    }
    let regimes = run["regimes"].as_array().unwrap();
    let names: Vec<&Value> = regimes.iter().map(|times| &times["regime"]).collect();
    assert_eq!(names, ["nothing", "camera", "light"], "no mesh moves");
    let [rest, camera, light] = [0, 1, 2].map(|index| &regimes[index]);
    assert_eq!(
        (&rest["uploaded_bytes"], &rest["frame"]["gpu_ms"]["p95"]),
        (&0.into(), &0.0.into())
    );
    let passes = run["passes"].as_array().unwrap().len();
    assert_eq!(rest["skipped"].as_array().unwrap().len(), passes);
    assert!(count(&camera["uploaded_bytes"]) > 0 && count(&light["uploaded_bytes"]) > 0);
    // Its map depends on the light, not on the camera.
    match run["preset"].as_str() {
        Some("nsm") => assert_eq!(camera["skipped"][1], "create_shadow_map.draw[0]"),
        _ => assert_eq!(camera["skipped"], Value::Null),
    }
    assert!(
        !light["skipped"].to_string().contains("create_shadow_map"),
        "{light}"
    );
    assert!(run["frame"]["wall_ms"]["median"].as_f64().unwrap() > 0.0);
    assert!(!run["passes"].as_array().unwrap().is_empty());
}

#[test]
fn a_document_of_a_folder_wins_over_a_built_in_one() {
    let folder = tempfile::tempdir().unwrap();
    fs::create_dir(folder.path().join("pipelines")).unwrap();
    fs::write(folder.path().join("pipelines/nsm.ron"), LIT).unwrap();
    fs::write(folder.path().join("all_lit.ron"), LIT).unwrap();
    let mut comparison = park_comparison(&["all_lit.ron", "nsm"], folder.path(), 32);
    comparison.protocol.pictures = true;
    let (_, results) = keep(&comparison, folder.path(), Kept::Others).unwrap();
    for run in results["runs"].as_array().unwrap() {
        assert_eq!(run["wrong"]["shadow"], 0);
        assert!(count(&run["wrong"]["lit"]) >= count(&run["pixels"]["shadow"]));
        assert_eq!(run["certain"]["lit"], run["pixels"]["facing_light"]);
    }
    let picture = folder.path().join("all_lit-bench_side-32x32-error.png");
    assert!(picture.is_file());
}

#[test]
fn outputs_that_break_the_contract_are_named_and_the_others_measured() {
    let folder = tempfile::tempdir().unwrap();
    let odd = LIT.replace("value: 2", "value: 7");
    fs::write(folder.path().join("odd.ron"), odd).unwrap();
    let comparison = park_comparison(&["odd.ron", "nsm"], folder.path(), 16);
    let text = refused(&comparison);
    assert!(
        text.contains("`odd.ron`") && text.contains("status is 7"),
        "{text}"
    );
    let (_, results) = keep(&comparison, folder.path(), Kept::Others).unwrap();
    let runs = &results["runs"];
    assert!(runs[0]["unavailable"].is_string());
    assert!(runs[0]["wrong"].is_null(), "nothing was measured");
    assert!(runs[1]["wrong"]["total"].is_u64());
}

#[test]
fn graphs_whose_pictures_would_overwrite_each_other_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    fs::create_dir(folder.path().join("a")).unwrap();
    fs::write(folder.path().join("a/b.ron"), LIT).unwrap();
    fs::write(folder.path().join("a-b.ron"), LIT).unwrap();
    let mut comparison = park_comparison(&["a/b.ron", "a-b.ron"], folder.path(), 8);
    comparison.protocol.pictures = true;
    let text = refused(&comparison);
    assert!(
        text.contains("`a/b.ron`") && text.contains("`a-b.ron`"),
        "{text}"
    );
}

#[test]
fn an_offset_beyond_all_proportion_is_refused() {
    let mut comparison = park_comparison(&["nsm"], NOWHERE.as_ref(), 8);
    comparison.protocol.oracle = OracleMode::Offset(1e300);
    let text = refused(&comparison);
    assert!(text.contains("offset is 1e300"), "{text}");
}

/// A floor, a sheet above it whose front faces the light, and a box beside the sheet.
const SHEET_AND_BOX: &str = "
v -9 0 -9\nv -9 0 9\nv 9 0 9\nv 9 0 -9\nf 1 2 3 4
v -4 2 -1\nv -4 2 1\nv -2 2 1\nv -2 2 -1\nf 5 6 7 8
v 2 1 -1\nv 2 1 1\nv 4 1 1\nv 4 1 -1\nv 2 2 -1\nv 2 2 1\nv 4 2 1\nv 4 2 -1
f 12 11 10 9\nf 13 14 15 16\nf 9 10 14 13\nf 10 11 15 14\nf 11 12 16 15\nf 12 9 13 16
";

/// The sheet deceives a proven method that culls front faces, the box only one that is wrong.
#[test]
fn what_blocks_certain_wrong_pixels_is_counted() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("lit.ron"), LIT).unwrap();
    let view = View {
        name: "above".into(),
        eye: DVec3::new(0.0, 12.0, 0.0),
        direction: DVec3::new(0.001, -1.0, 0.001),
        near: 1.0,
        far: 100.0,
        ..View::default()
    };
    let light = DirectionalLight::new(DVec3::new(1.0, -1.5, 0.4));
    let scene = mesh(folder.path(), SHEET_AND_BOX, view, light);
    let compare = |methods: &[&str]| {
        let mut comparison = comparison(scene.clone(), methods, folder.path(), &[256]);
        comparison.viewports = vec![[96, 96]];
        runs(&comparison)
    };
    let runs = compare(&["crsm", "lit.ron", "rt"]);
    let blockers = |run: &Value| {
        let kinds = ["open_part", "closed_part", "none"];
        kinds.map(|kind| count(&run["certain_wrong_blockers"][kind]))
    };
    let [open, 0, 0] = blockers(&runs[0]) else {
        panic!("{}", runs[0]);
    };
    assert!(
        open > 50 && open == count(&runs[0]["wrong"]["certain"]),
        "{}",
        runs[0]
    );
    let [in_open, in_closed, 0] = blockers(&runs[1]) else {
        panic!("{}", runs[1]);
    };
    assert!(in_open >= open && in_closed > 50, "{}", runs[1]);
    assert_eq!(runs[2].get("certain_wrong_blockers"), None);

    let runs = compare(&["crsm@cull=none"]);
    assert_eq!(runs[0]["wrong"]["certain"], 0);
    assert_eq!(runs[0].get("certain_wrong_blockers"), None);
}

/// A floor of 8 × 8, and a flat box of 2 × 2 over it.
const BOX_OVER_FLOOR: &str = "\
    v -4 0 -4\nv 4 0 -4\nv 4 0 4\nv -4 0 4\n\
    v -1 1 -1\nv -1 1 1\nv -1 1.2 -1\nv -1 1.2 1\nv 1 1 -1\nv 1 1 1\nv 1 1.2 -1\nv 1 1.2 1\n\
    f 1 4 3 2\nf 5 6 8 7\nf 9 11 12 10\nf 5 9 10 6\nf 7 8 12 11\nf 5 7 11 9\nf 6 10 12 8\n";

/// `rt` on the box, seen from afar with this near plane.
fn box_from_afar(folder: &Path, near: f64) -> Comparison {
    let view = View {
        name: "afar".into(),
        eye: DVec3::new(300.0, 3000.0, 10.0),
        direction: DVec3::new(-300.0, -3000.0, -10.0),
        fov_y_degrees: 0.2,
        near,
        far: 10000.0,
        ..View::default()
    };
    let light = DirectionalLight::new(DVec3::new(-0.4, -1.0, -0.55));
    let scene = mesh(folder, BOX_OVER_FLOOR, view, light);
    let mut comparison = comparison(scene, &["rt"], folder, &[]);
    comparison.viewports = vec![[64, 64]];
    comparison
}

#[test]
fn a_near_plane_however_near_leaves_the_picture_as_it_is() {
    let folder = tempfile::tempdir().unwrap();
    let compared = |near| runs(&box_from_afar(folder.path(), near)).remove(0);
    let expected = compared(100.0);
    assert!(count(&expected["pixels"]["shadow"]) > 50);
    for near in [0.1, 1e-4, 1e-10] {
        let run = compared(near);
        assert_eq!(run["pixels"], expected["pixels"], "near {near}");
        assert_eq!(run["wrong_surface"], 0, "near {near}");
    }
}

#[test]
fn a_surface_that_another_one_hides_is_counted() {
    /// A G-buffer that shows the farthest surface instead of the nearest one.
    struct Farthest;

    impl Sources for Farthest {
        fn read(&self, path: &str) -> Result<Option<std::sync::Arc<str>>, String> {
            let (nearest, farthest) = ("load: Clear(0), compare: Greater", "load: Clear(1)");
            let text = EmbeddedSources.read(path)?;
            Ok(text.map(|text| text.replace(nearest, farthest).into()))
        }

        fn list(&self, folder: &str) -> Vec<String> {
            EmbeddedSources.list(folder)
        }
    }

    let folder = tempfile::tempdir().unwrap();
    let mut comparison = box_from_afar(folder.path(), 100.0);
    comparison.primary = PrimaryVisibility::load(&Farthest).unwrap();
    let (_, results) = keep(&comparison, folder.path(), Kept::Others).unwrap();
    let hidden = count(&results["runs"][0]["wrong_surface"]);
    // The box covers a sixteenth of the floor.
    assert!(hidden > 100, "{hidden}");
    let csv = fs::read_to_string(folder.path().join("results.csv")).unwrap();
    let mut lines = csv::Reader::from_reader(csv.as_bytes());
    let column = lines
        .headers()
        .unwrap()
        .iter()
        .position(|head| head == "wrong_surface");
    let cells = lines.records().next().unwrap().unwrap();
    assert_eq!(&cells[column.unwrap()], hidden.to_string());
}

#[test]
fn what_fits_is_measured_and_the_rest_says_why_it_does_not() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("lit.ron"), LIT).unwrap();
    let mut request = GpuRequest::default();
    request.memory_limit = Some(1 << 20);
    let compare = |methods: &[&str]| {
        let mut comparison = comparison(park(), methods, folder.path(), &[]);
        comparison.viewports = vec![[16, 16]];
        let graphs = comparison.methods.iter().map(|method| &method.preset.graph);
        let gpu = device::open(&request, graphs).unwrap();
        block_on(series::run(&comparison, Session::new(&gpu, &Silent)))
    };
    let runs = compare(&["lit.ron", "nsm"]).unwrap().runs;
    assert!(runs[0].measured.is_some());
    let reason = runs[1].unavailable.as_deref().unwrap();
    let why = "the materials of `pipelines/nsm.ron` take 4.0 MiB, but there are only 1.0 MiB";
    assert!(reason.contains(why), "{reason}");
    let text = compare(&["nsm"]).unwrap_err().to_string();
    assert!(text.contains("shadow_map"), "{text}");
}
