//! `compare` and `run` for real. They need an adapter; a machine without one fails here with the
//! program's own advice.

use crate::timeless::timeless;
use serde_json::Value;
use std::{
    fs,
    path::Path,
    process::{Command, Output},
};

/// A graph that clears two textures and calls them a shadow method.
const LIT: &str = include_str!("support/lit.ron");

#[track_caller]
fn skiagraph(folder: &Path, line: &str) -> Output {
    let output = Command::new(env!("CARGO_BIN_EXE_skiagraph"))
        .args(line.split_whitespace())
        .current_dir(folder)
        .env("NO_COLOR", "1")
        .env("SKIAGRAPH_PROGRESS", "lines")
        .output()
        .expect("the program was built for this test");
    assert!(
        output.status.success(),
        "{line}: {}\n{}\n{}",
        output.status,
        String::from_utf8_lossy(&output.stdout),
        String::from_utf8_lossy(&output.stderr)
    );
    output
}

fn count(value: &Value) -> u64 {
    value
        .as_u64()
        .unwrap_or_else(|| panic!("{value} is not a count"))
}

fn png(path: &Path) -> image::RgbImage {
    image::open(path)
        .unwrap_or_else(|error| panic!("{}: {error}", path.display()))
        .to_rgb8()
}

#[test]
fn compare_measures_judges_and_pictures_every_run() {
    let folder = tempfile::tempdir().unwrap();
    let line = "compare rt nsm --size 64x64,96x48 --map-size 64,256 --frames 2 --warmup 0 --out \
        results --format json";
    let output = skiagraph(folder.path(), line);
    let out = folder.path().join("results");
    let text = fs::read_to_string(out.join("results.json")).unwrap();
    assert_eq!(
        text,
        String::from_utf8_lossy(&output.stdout),
        "--format json prints the file"
    );
    let results: Value = serde_json::from_str(&text).unwrap();
    assert_eq!(results["schema"], 1);
    assert_eq!(results["scene"]["name"], "park");
    let runs = results["runs"].as_array().unwrap();
    let keys: Vec<_> = runs
        .iter()
        .map(|run| (run["preset"].as_str(), &run["viewport"], &run["map_size"]))
        .collect();
    assert_eq!(
        keys.len(),
        6,
        "rt once and nsm twice, on two viewports: {keys:?}"
    );

    for run in runs {
        let [width, height] = [0, 1].map(|axis| count(&run["viewport"][axis]));
        let pixels = &run["pixels"];
        let classes =
            ["background", "facing_away", "facing_light"].map(|class| count(&pixels[class]));
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
            let said =
                ["certain_right", "certain_wrong", "uncertain"].map(|word| count(&split[word]));
            assert_eq!(said.iter().sum::<u64>(), count(&pixels[class]), "{split}");
        }
        match run["preset"].as_str() {
            // Its map depends on the light, not on the camera, which is all that moves.
            Some("nsm") => assert_eq!(run["cached"]["skipped"][1], "create_shadow_map.draw[0]"),
            _ => assert_eq!(run["cached"], Value::Null),
        }
        assert!(run["frame"]["wall_ms"]["median"].as_f64().unwrap() > 0.0);
        assert!(!run["passes"].as_array().unwrap().is_empty());
        for kind in ["shaded", "visibility", "error", "uncertain"] {
            let picture = png(&out.join(run["images"][kind].as_str().unwrap()));
            assert_eq!(picture.dimensions(), (width as u32, height as u32));
        }
    }
    let purple = |stem: &str| {
        let picture = png(&out.join(format!("{stem}-uncertain.png")));
        let purple = |pixel: &&image::Rgb<u8>| pixel.0 == [160, 32, 240];
        picture.pixels().filter(purple).count() as u64
    };
    assert_eq!(purple("nsm-bench_side-64x64-map64"), 0);
    assert!(purple("rt-bench_side-64x64") >= count(&runs[0]["uncertain"]));
    let of = |preset| runs.iter().filter(move |run| run["preset"] == preset);
    for run in of("rt") {
        assert_eq!(
            count(&run["wrong"]["total"]),
            count(&run["wrong"]["in_band"]),
            "rays are exact outside the band"
        );
        assert_eq!(run["map_size"], Value::Null);
        assert!(count(&run["rays"]) > 0);
    }
    let wrong: Vec<u64> = of("nsm").map(|run| count(&run["wrong"]["total"])).collect();
    assert!(
        wrong[1] < wrong[0],
        "a larger map is wrong less often: {wrong:?}"
    );

    let lines = fs::read_to_string(out.join("results.csv"))
        .unwrap()
        .lines()
        .count();
    assert_eq!(lines, 7, "a header and a line per run");
    png(&out.join("reference-bench_side-64x64-visibility.png"));
}

#[test]
fn a_file_on_disk_stands_beside_the_presets_and_wins_over_one_of_its_path() {
    let folder = tempfile::tempdir().unwrap();
    fs::create_dir(folder.path().join("pipelines")).unwrap();
    fs::write(folder.path().join("pipelines/nsm.ron"), LIT).unwrap();
    fs::write(folder.path().join("all_lit.ron"), LIT).unwrap();
    let output = skiagraph(
        folder.path(),
        "compare all_lit.ron nsm --size 32x32 --frames 1 --out . --format json",
    );
    let results: Value = serde_json::from_slice(&output.stdout).unwrap();
    for run in results["runs"].as_array().unwrap() {
        assert_eq!(run["wrong"]["shadow"], 0);
        assert!(count(&run["wrong"]["lit"]) >= count(&run["pixels"]["shadow"]));
        assert_eq!(run["certain"]["lit"], run["pixels"]["facing_light"]);
    }
    assert!(
        folder
            .path()
            .join("all_lit-bench_side-32x32-error.png")
            .is_file()
    );
}

/// A folder with presets on disk: a new one, one in place of a built-in one, and a sub-graph, which
/// is none. Also what `presets` lists there.
fn presets_on_disk() -> (tempfile::TempDir, Vec<String>) {
    let folder = tempfile::tempdir().unwrap();
    let pipelines = folder.path().join("pipelines");
    fs::create_dir_all(pipelines.join("shared")).unwrap();
    for name in ["all_lit.ron", "crsm_depth.ron", "shared/part.ron"] {
        fs::write(pipelines.join(name), LIT).unwrap();
    }
    let text = skiagraph(folder.path(), "presets").stdout;
    let text = String::from_utf8(text).unwrap();
    let heads = text.lines().filter(|line| !line.starts_with(' '));
    let names = heads.filter_map(|line| Some(line.split_once(':')?.0.to_owned()));
    let listed: Vec<String> = names.collect();
    for (name, is_listed) in [("all_lit", true), ("nsm", true), ("part", false)] {
        assert_eq!(listed.iter().any(|listed| listed == name), is_listed);
    }
    (folder, listed)
}

fn preset_names(entries: &Value) -> Vec<&str> {
    let entries = entries.as_array().unwrap().iter();
    entries
        .filter_map(|entry| entry["preset"].as_str())
        .collect()
}

#[test]
fn a_bare_compare_takes_the_presets_that_presets_lists() {
    let (folder, listed) = presets_on_disk();
    let line = "compare --size 8x8 --map-size 8 --frames 1 --warmup 0 --cached-frames 0 --images \
        none --out . --format json";
    let results: Value = serde_json::from_slice(&skiagraph(folder.path(), line).stdout).unwrap();
    assert_eq!(preset_names(&results["runs"]), listed);
    let runs = results["runs"].as_array().unwrap();
    let own = runs
        .iter()
        .find(|run| run["preset"] == "crsm_depth")
        .unwrap();
    let facing = count(&own["pixels"]["facing_light"]);
    assert_eq!(count(&own["certain"]["lit"]), facing, "the file wins");
}

#[test]
#[ignore = "a suite: `./test.sh --all` runs it"]
fn a_bare_stress_takes_the_presets_that_presets_lists() {
    let (folder, listed) = presets_on_disk();
    let line = "stress --case box_on_floor --size 16x16 --map-size 8 --format json";
    let output = Command::new(env!("CARGO_BIN_EXE_skiagraph"))
        .args(line.split_whitespace())
        .current_dir(folder.path())
        .output()
        .unwrap();
    let report: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(preset_names(&report["methods"]), listed);
    let cells = report["cases"][0]["cells"].as_array().unwrap();
    let own = cells
        .iter()
        .find(|cell| cell["preset"] == "crsm_depth")
        .unwrap();
    assert_eq!(
        own["verdict"], "unjudged",
        "the file, which claims nothing, wins"
    );
}

#[test]
fn run_saves_outputs_and_materials_and_says_what_ran() {
    let folder = tempfile::tempdir().unwrap();
    let line = "run nsm --size 48x32 --map-size 64 --save visibility=v.png --save status=s.png \
        --save shadow_map@create_shadow_map.draw[0]=map.png --save primitive=ids.bin --save \
        primitive=ids.png";
    let output = skiagraph(folder.path(), line);
    let text = String::from_utf8_lossy(&output.stdout);
    assert!(text.contains("create_shadow_map"), "{text}");
    assert!(
        !text.contains("scene.bvh"),
        "no hierarchy is built for a shadow map:\n{text}"
    );
    for (name, size) in [
        ("v.png", (48, 32)),
        ("s.png", (48, 32)),
        ("ids.png", (48, 32)),
        ("map.png", (64, 64)),
    ] {
        assert_eq!(png(&folder.path().join(name)).dimensions(), size, "{name}");
    }
    let black_or_white = |pixel: &image::Rgb<u8>| pixel.0 == [0; 3] || pixel.0 == [255; 3];
    assert!(
        png(&folder.path().join("v.png"))
            .pixels()
            .all(black_or_white)
    );
    assert_eq!(
        fs::read(folder.path().join("ids.bin")).unwrap().len(),
        48 * 32 * 4
    );
}

#[test]
fn run_shows_a_mesh_of_ones_own() {
    let folder = tempfile::tempdir().unwrap();
    // A floor at y = 0 and a lid over its middle at y = 1, seen from above and lit from above.
    let quad = |y: f32, half: f32| {
        format!(
            "v {0} {y} {0}\nv {1} {y} {0}\nv {1} {y} {1}\nv {0} {y} {1}\n",
            -half, half
        )
    };
    let mesh = format!("{}{}f 4 3 2 1\nf 8 7 6 5\n", quad(0.0, 2.0), quad(1.0, 0.5));
    fs::write(folder.path().join("lid.obj"), mesh).unwrap();
    let line = "run rt --scene lid.obj --eye -3,5,0 --look 3,-5,0 --light 0,-1,0 --size 64x64 \
        --save visibility=v.png --save status=s.png";
    skiagraph(folder.path(), line);
    let picture = png(&folder.path().join("s.png"));
    let statuses: std::collections::BTreeSet<_> = picture.pixels().map(|pixel| pixel.0).collect();
    assert!(statuses.len() > 1, "floor and background: {statuses:?}");
    let visibility = png(&folder.path().join("v.png"));
    let lit = visibility
        .pixels()
        .filter(|pixel| pixel.0 == [255; 3])
        .count();
    assert!(lit > 100 && lit < 64 * 64, "{lit} lit pixels");
}

#[test]
fn an_unwritable_file_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let output = Command::new(env!("CARGO_BIN_EXE_skiagraph"))
        .args([
            "run",
            "nsm",
            "--size",
            "16x16",
            "--save",
            "visibility=nowhere/v.png",
        ])
        .current_dir(folder.path())
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(1));
    let text = String::from_utf8_lossy(&output.stderr);
    assert!(
        text.contains("nowhere/v.png") || text.contains("nowhere\\v.png"),
        "{text}"
    );
}

#[test]
fn outputs_that_break_the_contract_are_named_and_the_others_measured() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(
        folder.path().join("odd.ron"),
        LIT.replace("value: 2", "value: 7"),
    )
    .unwrap();
    let output = Command::new(env!("CARGO_BIN_EXE_skiagraph"))
        .args("compare odd.ron nsm --size 16x16 --map-size 16 --frames 1 --out .".split(' '))
        .current_dir(folder.path())
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(1));
    let text = String::from_utf8_lossy(&output.stderr);
    assert!(
        text.contains("`odd.ron`") && text.contains("status is 7"),
        "{text}"
    );
    let results = fs::read_to_string(folder.path().join("results.json")).unwrap();
    let results: Value = serde_json::from_str(&results).unwrap();
    assert!(results["runs"][0]["unavailable"].is_string());
    assert!(
        results["runs"][0]["wrong"].is_null(),
        "nothing was measured"
    );
    assert!(results["runs"][1]["wrong"]["total"].is_u64());
}

#[test]
fn graphs_whose_pictures_would_overwrite_each_other_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    fs::create_dir(folder.path().join("a")).unwrap();
    fs::write(folder.path().join("a/b.ron"), LIT).unwrap();
    fs::write(folder.path().join("a-b.ron"), LIT).unwrap();
    let output = Command::new(env!("CARGO_BIN_EXE_skiagraph"))
        .args("compare a/b.ron a-b.ron --size 8x8 --frames 1 --out results".split(' '))
        .current_dir(folder.path())
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(1));
    let text = String::from_utf8_lossy(&output.stderr);
    assert!(
        text.contains("`a/b.ron`") && text.contains("`a-b.ron`"),
        "{text}"
    );
    assert!(!folder.path().join("results").exists(), "nothing ran");
}

#[test]
fn an_offset_beyond_all_proportion_is_refused_at_once() {
    let folder = tempfile::tempdir().unwrap();
    let output = Command::new(env!("CARGO_BIN_EXE_skiagraph"))
        .args("compare nsm --size 8x8 --frames 1 --oracle offset:1e300 --out .".split(' '))
        .current_dir(folder.path())
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(1));
    let text = String::from_utf8_lossy(&output.stderr);
    assert!(text.contains("offset is 1e300"), "{text}");
}

#[test]
fn a_buffer_has_no_picture_but_bytes() {
    let folder = tempfile::tempdir().unwrap();
    let save = |file: &str| {
        Command::new(env!("CARGO_BIN_EXE_skiagraph"))
            .args(["run", "rt", "--size", "8x8", "--save"])
            .arg(format!("ray_count={file}"))
            .current_dir(folder.path())
            .output()
            .unwrap()
    };
    let picture = save("count.png");
    assert_eq!(picture.status.code(), Some(1));
    assert!(String::from_utf8_lossy(&picture.stderr).contains("save it as .csv or .bin"));
    assert_eq!(save("count.bin").status.code(), Some(0));
    let count = fs::read(folder.path().join("count.bin")).unwrap();
    let count = u32::from_le_bytes(count.try_into().unwrap());
    assert!(count > 0 && count <= 64, "{count} rays for 64 pixels");
}

fn results(folder: &Path) -> Value {
    let text = fs::read_to_string(folder.join("results.json")).unwrap();
    serde_json::from_str(&text).unwrap()
}

#[test]
#[ignore = "a suite: `./test.sh --all` runs it"]
fn settings_stand_beside_each_other_and_runs_that_are_there_stay() {
    let folder = tempfile::tempdir().unwrap();
    let common = "--size 16x16 --map-size 8 --frames 1 --warmup 0 --out out";
    let names = || -> Vec<String> {
        let results = results(&folder.path().join("out"));
        let runs = results["runs"].as_array().unwrap().iter();
        runs.map(|run| run["preset"].as_str().unwrap().to_owned())
            .collect()
    };
    skiagraph(folder.path(), &format!("compare rt {common}"));
    let line = format!("compare crsm@n=1,depth=plane crsm {common} --set cull=front,none");
    let output = skiagraph(folder.path(), &line);
    let text = String::from_utf8_lossy(&output.stderr);
    assert!(
        text.contains("1 other run that out/results.json holds already stays"),
        "{text}"
    );
    let own = ["n=1,depth=plane,cull=front", "n=1,depth=plane,cull=none"];
    let all = own.into_iter().chain(["cull=front", "cull=none"]);
    let expected: Vec<String> = all.map(|set| format!("crsm@{set}")).collect();
    assert_eq!(names(), [&expected[..], &["rt".into()]].concat());
    png(&folder
        .path()
        .join("out/crsm-n-1-depth-plane-cull-none-bench_side-16x16-map8-error.png"));
    // The verdict is over all that is there.
    let table = String::from_utf8_lossy(&output.stdout);
    assert!(table.contains("│ rt"), "{table}");
    skiagraph(folder.path(), &format!("compare nsm {common} --replace"));
    assert_eq!(names(), ["nsm"]);
}

#[test]
#[ignore = "a suite: `./test.sh --all` runs it"]
fn a_view_and_a_light_of_ones_own_on_any_scene() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("mesh.obj"), SHEET_AND_BOX).unwrap();
    let compare = |rest: &str| {
        let line = format!(
            "compare rt --size 32x32 --frames 1 --warmup 0 --images none --replace --out . {rest}"
        );
        let output = skiagraph(folder.path(), &line);
        let run = results(folder.path())["runs"][0].clone();
        (run, String::from_utf8_lossy(&output.stderr).into_owned())
    };
    let (park, _) = compare("--scene park");
    let (lit, _) = compare("--scene park --light 1,-1,0.2");
    assert_eq!(
        (&park["view"], &lit["view"]),
        (&"bench_side".into(), &"own".into())
    );
    assert_ne!(
        park["pixels"]["facing_light"],
        lit["pixels"]["facing_light"]
    );
    assert_eq!(park["pixels"]["background"], lit["pixels"]["background"]);
    let (above, _) = compare("--scene park --eye 0,20,0.1 --look 0.001,-1,0.001");
    assert_eq!(
        above["pixels"]["background"], 0,
        "straight down there is ground"
    );
    // All of a bare mesh is seen, and it is said from where.
    let (mesh, text) = compare("--scene mesh.obj");
    assert!(text.contains("chosen: --eye "), "{text}");
    assert!(count(&mesh["pixels"]["facing_light"]) > 50, "{mesh}");
    assert!(count(&mesh["pixels"]["background"]) > 0, "{mesh}");
    let output = Command::new(env!("CARGO_BIN_EXE_skiagraph"))
        .args("compare rt --path walk --eye 0,1,0".split(' '))
        .current_dir(folder.path())
        .output()
        .unwrap();
    let text = String::from_utf8_lossy(&output.stderr);
    assert!(text.contains("--path walk brings its camera"), "{text}");
}

/// `rt` is judged under the light that it has drawn with, and a run of another light is not kept.
#[test]
fn a_views_own_light_is_drawn_judged_and_remembered() {
    let folder = tempfile::tempdir().unwrap();
    let compare = |light: &str, rest: &str| {
        let scene = format!(
            r#"(format: 1, name: "s", mesh: Generated("park"), light: (direction: (1, -1, 0)),
            views: [(name: "a", eye: (-23.277, 18.541, 30.143), direction: (0.397, -0.645, -0.652),
                fov_y_degrees: 60, near: 1, far: 400{light})])"#
        );
        fs::write(folder.path().join("s.ron"), scene).unwrap();
        let line = format!(
            "compare rt --scene s.ron --size 48x48 --frames 1 --warmup 0 --images none --out out \
             {rest}"
        );
        let output = skiagraph(folder.path(), &line);
        let run = results(&folder.path().join("out"))["runs"][0].clone();
        let wrong = &run["wrong"];
        assert_eq!(wrong["total"], wrong["in_band"], "{light}");
        let text = String::from_utf8_lossy(&output.stderr).into_owned();
        (count(&run["pixels"]["shadow"]), text)
    };
    let (of_scene, _) = compare("", "");
    let (own, text) = compare(", light: (direction: (-1, -0.3, 0.2))", "--resume");
    assert!(text.contains("0 of 1 runs are kept"), "{text}");
    assert!(own > 0 && own != of_scene, "{own} shadow pixels");
    let (same, text) = compare(", light: (direction: (-1, -0.3, 0.2))", "--resume");
    assert!(text.contains("1 of 1 runs are kept"), "{text}");
    assert_eq!(same, own);
}

/// Under a light that has an extent all is judged by shares; a graph needs no status.
#[test]
#[ignore = "a suite: `./test.sh --all` runs it"]
fn a_light_with_extent_is_judged_by_shares() {
    let folder = tempfile::tempdir().unwrap();
    let bare = LIT.replace(", \"status\"]", "]");
    let soft = bare.replace(
        "visibility\", format: R8Uint",
        "visibility\", format: R16Float",
    );
    fs::write(folder.path().join("lit.ron"), bare).unwrap();
    fs::write(
        folder.path().join("half.ron"),
        soft.replace("value: 1", "value: 0.5"),
    )
    .unwrap();
    fs::write(
        folder.path().join("odd.ron"),
        soft.replace("value: 1", "value: 1.5"),
    )
    .unwrap();
    let compare = |scene: &str, rest: &str| {
        let line = format!(
            "compare lit.ron half.ron odd.ron --scene {scene} --view bench_side --size 32x32 \
             --frames 1 --warmup 0 --cached-frames 0 --out out-{scene} {rest}"
        );
        let output = skiagraph(folder.path(), &line);
        let text = String::from_utf8_lossy(&output.stdout).into_owned();
        let log = String::from_utf8_lossy(&output.stderr).into_owned();
        (
            results(&folder.path().join(format!("out-{scene}")))["runs"].clone(),
            text,
            log,
        )
    };
    let (runs, text, _) = compare("park", "");
    assert!(
        text.contains("Hard answers against the hard reference"),
        "{text}"
    );
    assert!(
        text.contains("Graded answers against the hard reference"),
        "{text}"
    );
    assert_eq!(
        (&runs[0]["answer"], &runs[0]["graded"]),
        (&"hard".into(), &Value::Null)
    );
    let certain = count(&runs[0]["certain"]["lit"]);
    assert_eq!(
        certain,
        count(&runs[0]["pixels"]["facing_light"]),
        "certain of all that it lights"
    );
    assert_eq!(runs[1]["answer"], "graded");
    assert_eq!(runs[1]["graded"]["rmse"], 0.5);
    assert_eq!(count(&runs[2]["graded"]["invalid"]["outside"]), certain);
    assert!(text.contains("odd.ron: visibility that is not a share of light: outside 0 to 1"));

    let soft = park_with_width();
    fs::write(folder.path().join("soft.ron"), soft).unwrap();
    let (runs, text, _) = compare("soft.ron", "--reference-samples 32");
    assert!(text.contains("reference of 32 samples per pixel"), "{text}");
    assert!(text.contains("The least error"), "{text}");
    let area = &runs[0]["area"];
    assert_eq!(area["samples"], 32);
    assert!(count(&area["penumbra"]) > 20);
    assert!(area["standard_error_rms"].as_f64().unwrap() > 0.0);
    // A hard answer is judged by shares, too; what is lit throughout is off by the shadow alone.
    let mean = |run: usize| runs[run]["graded"]["mean_absolute_error"].as_f64().unwrap();
    assert_eq!(runs[0]["answer"], "hard");
    assert!(mean(0) < 0.5 && mean(0) > 0.01, "{}", mean(0));
    assert_eq!(mean(0), mean(2), "1.5 counts as 1");
    // Another number of samples is another reference.
    let (_, _, log) = compare("soft.ron", "--reference-samples 32 --resume");
    assert!(log.contains("3 of 3 runs are kept"), "{log}");
    let (_, _, log) = compare("soft.ron", "--reference-samples 64 --resume");
    assert!(log.contains("0 of 3 runs are kept"), "{log}");
}

/// Park under a spot light, a point light and a directional one.
const LAMPS: &str = include_str!("../../../../scenes/lamps.ron");

/// A graph that includes `rt` for each light.
const EVERY_LIGHT: &str = r#"(
    format: 3,
    materials: [
        Texture(name: "visibility", format: R32Uint, layers: "lights.count"),
        Texture(name: "status", format: R32Uint, layers: "lights.count"),
    ],
    passes: [
        Include(
            graph: "rt.ron",
            name: "lit",
            repeat: "lights.count",
            bind: {
                "light": "lights[index]",
                "visibility": "visibility[index]",
                "status": "status[index]",
            },
        ),
    ],
    outputs: ["visibility", "status"],
    lights: [directional, spot, point],
)"#;

/// Spot, point and directional: each layer against its own light, whatever the others are.
#[test]
#[ignore = "a suite: `./test.sh --all` runs it"]
fn a_layer_for_each_light_is_judged_by_itself() {
    let folder = tempfile::tempdir().unwrap();
    let turned = EVERY_LIGHT.replace("lights[index]", "lights[lights.count - 1 - index]");
    fs::write(folder.path().join("lamps.ron"), LAMPS).unwrap();
    fs::write(folder.path().join("each.ron"), EVERY_LIGHT).unwrap();
    fs::write(folder.path().join("turned.ron"), turned).unwrap();
    let compare = |rest: &str| {
        let line = format!(
            "compare each.ron turned.ron --scene lamps.ron --size 64x48 --frames 1 --warmup 0 \
             --cached-frames 0 --images none --replace --out out {rest}"
        );
        skiagraph(folder.path(), &line);
        results(&folder.path().join("out"))["runs"].clone()
    };
    let outside = |run: &Value| count(&run["wrong"]["total"]) - count(&run["wrong"]["in_band"]);
    let runs = compare("");
    let runs: Vec<Value> = runs.as_array().unwrap().clone();
    let views: Vec<String> = runs
        .iter()
        .map(|run| run["view"].as_str().unwrap().to_owned())
        .collect();
    let lights = ["lamp", "lamp", "bulb", "bulb", "moon", "moon"];
    assert_eq!(views, lights.map(|light| format!("bench@{light}")));
    let wrong: Vec<u64> = runs.iter().map(outside).collect();
    assert_eq!([wrong[0], wrong[2], wrong[4]], [0; 3]);
    // The second of three is the second from the end.
    assert!(
        wrong[1] > 100 && wrong[3] == 0 && wrong[5] > 100,
        "{wrong:?}"
    );
    let bulb = compare("--light bulb");
    assert_eq!(bulb.as_array().unwrap().len(), 2);
    assert_eq!(bulb[0]["pixels"], runs[2]["pixels"]);
    assert_eq!(outside(&bulb[0]), 0);
}

/// A `fit` under a light that has but one.
#[test]
fn params_without_effect_are_told_once() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("lamps.ron"), LAMPS).unwrap();
    let told = |rest: &str| {
        let line = format!("{rest} --scene lamps.ron --size 16x16 --set fit=camera");
        let output = skiagraph(folder.path(), &line);
        let log = String::from_utf8_lossy(&output.stderr).into_owned();
        log.matches("fit=camera has no effect on nsm under a spot light")
            .count()
    };
    let compare = "compare nsm rt --frames 1 --warmup 0 --images none --out out";
    assert_eq!(told(&format!("{compare} --light all")), 1);
    assert_eq!(told(&format!("{compare} --light moon")), 0);
    assert_eq!(told("run nsm --light lamp"), 1);
}

/// The park's first view under a wide light.
fn park_with_width() -> String {
    r#"(format: 1, name: "soft", mesh: Generated("park"),
        light: (direction: (0.744, -0.408, 0.527), angle_degrees: 8),
        views: [(name: "bench_side", eye: (-23.277, 18.541, 30.143),
            direction: (0.397, -0.645, -0.652), fov_y_degrees: 60, near: 1, far: 400)])"#
        .into()
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
fn what_blocks_certain_wrong_pixels_is_told() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("mesh.obj"), SHEET_AND_BOX).unwrap();
    fs::write(folder.path().join("lit.ron"), LIT).unwrap();
    let compare = |rest: &str| {
        let line = format!(
            "compare {rest} --scene mesh.obj --eye 0,12,0 --look 0.001,-1,0.001 --light 1,-1.5,0.4 \
             --fov 60 --near 1 --far 100 --size 96x96 --map-size 256 --frames 1 --warmup 0 \
             --images none --replace --out out"
        );
        let output = skiagraph(folder.path(), &line);
        let text = String::from_utf8_lossy(&output.stdout).into_owned();
        (text, results(&folder.path().join("out"))["runs"].clone())
    };
    let (text, runs) = compare("crsm lit.ron rt");
    let blockers = |run: &Value| {
        let kinds = ["open_part", "closed_part", "none"];
        kinds.map(|kind| count(&run["certain_wrong_blockers"][kind]))
    };
    let [open, 0, 0] = blockers(&runs[0]) else {
        panic!("{}", runs[0]);
    };
    assert!(
        open > 50 && open == count(&runs[0]["wrong"]["certain"]),
        "{runs}"
    );
    let line = format!(
        "crsm 256: certain wrong outside the band {open}, blocker in an open part {open}\n"
    );
    assert!(text.contains(&line), "{text}");
    let [in_open, in_closed, 0] = blockers(&runs[1]) else {
        panic!("{}", runs[1]);
    };
    assert!(in_open >= open && in_closed > 50, "{}", runs[1]);
    let line = format!("blocker in an open part {in_open}, blocker in a closed part {in_closed}\n");
    assert!(text.contains(&line), "{text}");
    assert_eq!(runs[2].get("certain_wrong_blockers"), None);

    let (text, runs) = compare("crsm --set cull=none");
    assert_eq!(runs[0]["wrong"]["certain"], 0);
    assert_eq!(runs[0].get("certain_wrong_blockers"), None);
    assert!(!text.contains("blocker"), "{text}");
}

#[test]
#[ignore = "a suite: `./test.sh --all` runs it"]
fn a_document_holds_what_was_measured_and_needs_no_pictures() {
    let folder = tempfile::tempdir().unwrap();
    let line = "compare nsm rt --view all --size 16x16 --map-size 8 --frames 1 --cached-frames 0 \
        --images none --out . --format markdown";
    let output = skiagraph(folder.path(), line);
    let text = String::from_utf8_lossy(&output.stdout);
    assert!(text.contains(&format!("    skiagraph {line}\n")), "{text}");
    assert_eq!(text.matches("\n### ").count(), 9, "{text}");
    assert_eq!(text.matches("\n| nsm | 8 |").count(), 9, "{text}");
    let results = results(folder.path());
    for run in results["runs"].as_array().unwrap() {
        assert!(run.get("images").is_none() && run["wrong"].is_object());
        assert_eq!(run["cached"], Value::Null);
    }
    let files = fs::read_dir(folder.path()).unwrap();
    let names = files.map(|file| file.unwrap().file_name().into_string().unwrap());
    let mut names: Vec<String> = names.collect();
    names.sort();
    let expected = [
        ".skiagraph-results.lock",
        "report.html",
        "results.csv",
        "results.json",
    ];
    assert_eq!(names, expected);
    // A document is written from kept runs alone, too.
    let again = skiagraph(folder.path(), &format!("{line} --resume"));
    let again = String::from_utf8_lossy(&again.stdout);
    // Above the tables stands the date, which may be another by now.
    let tables = |text: &str| {
        text.split_once("\n### ")
            .map(|(_, tables)| tables.to_owned())
    };
    assert_eq!(tables(&again), tables(&text));
}

#[test]
fn published_figures_stand_beside_ours_even_in_kept_runs() {
    let folder = tempfile::tempdir().unwrap();
    let line = "compare nsm rt --size 16x16 --map-size 8 --frames 1 --out . --format markdown";
    skiagraph(folder.path(), line);
    let published = "scene,view,viewport,map_size,preset,quantity,value,source,note
park,bench_side,16x16,,,facing_light,12345,table 6,
park,bench_side,16x16,8,nsm,wrong_percent,5.3,table 12,misprint
park,bench_side,16x16,16,nsm,wrong_percent,6.3,table 12,
";
    fs::write(folder.path().join("d.csv"), published).unwrap();
    let output = skiagraph(folder.path(), &format!("{line} --resume --beside D:d.csv"));
    let text = String::from_utf8_lossy(&output.stdout);
    for part in [" (D 12,345) ", " (D 5.30¹) ", "¹ D, table 12: misprint"] {
        assert!(text.contains(part), "no {part:?} in\n{text}");
    }
    // The figure of a map that was not measured stands nowhere.
    assert_eq!(text.matches("(D ").count(), 2, "{text}");
    let results = results(folder.path());
    let counts = ["nsm", "rt"].map(|preset| {
        let mut runs = results["runs"].as_array().unwrap().iter();
        let run = runs.find(|run| run["preset"] == preset).unwrap();
        run["published"].as_array().unwrap().len()
    });
    assert_eq!(counts, [2, 1]);
}

/// The dissertation's figures as if they were of `park` in viewports that are soon drawn; its views
/// are called like those of `bench`.
fn dissertation_of_park() -> String {
    let text = include_str!("../../../../docs/data/dissertation.csv");
    let sizes = [
        ("512x512,", "16x16,"),
        ("1024x1024,", "24x24,"),
        ("1920x1080,", "32x18,"),
    ];
    let text = text.replace("\nbench,", "\npark,");
    sizes
        .iter()
        .fold(text, |text, (size, small)| text.replace(size, small))
}

#[test]
#[ignore = "a suite: `./test.sh --all` runs it"]
fn the_dissertations_charts_stand_beside_ours() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("d.csv"), dissertation_of_park()).unwrap();
    let common = "--map-size 512,1024 --frames 1 --warmup 0 --cached-frames 0 --images none";
    for what in [
        "rt nsm hybrid_pcf crsm crsm_depth --view bench_with --size 16x16,24x24 --out with",
        "nsm hybrid_pcf --view bench_side --size 24x24 --out side",
    ] {
        skiagraph(folder.path(), &format!("compare {what} {common}"));
    }
    let output = skiagraph(
        folder.path(),
        "chart with side --beside D:d.csv --out charts",
    );
    let told = String::from_utf8_lossy(&output.stderr);
    for line in [
        "not drawn, of our park: preset crsm_depth: D has no figures",
        "not drawn: D's sponza: no results of it",
        "not in ms-trace-rays-by-map: park bench_side: no two map sizes",
        "27 charts in charts",
    ] {
        assert!(told.contains(line), "no {line:?} in\n{told}");
    }
    let lacking = "view bench_against, flowers_against, flowers_side, flowers_with, trees_against, \
        trees_side, trees_with; viewport 32x18; map 2048², 4096²; preset crsma: no results";
    assert!(told.contains(lacking), "{told}");
    let files = fs::read_dir(folder.path().join("charts")).unwrap();
    let mut names: Vec<String> = files
        .map(|file| file.unwrap().file_name().into_string().unwrap())
        .collect();
    names.sort();
    let quantities = [
        "certain-right",
        "certain-wrong",
        "fps",
        "ms-create-shadow-map",
        "ms-fill-rays",
        "ms-fix-pixels",
        "ms-gbuffer-detect-uncertain",
        "ms-steps",
        "ms-trace-rays",
        "uncertain",
        "wrong",
        "wrong-lit",
        "wrong-shadow",
    ];
    let by = |name| ["map", "viewport"].map(|by| format!("{name}-by-{by}.svg"));
    let mut expected: Vec<String> = quantities.into_iter().flat_map(by).collect();
    expected.push("time-by-viewport.svg".into());
    expected.sort();
    assert_eq!(names, expected);
    // Its pairs of panels, the bars of one of them, and the series.
    for (name, pairs, bars, series) in [
        // Both views in the viewport of which D has several maps.
        ("wrong-shadow-by-map", 2, 7, "nsm"),
        // bench_with in two viewports, at the map of which D has several.
        ("wrong-lit-by-viewport", 1, 4, "nsm"),
        // Two methods and one.
        ("uncertain-by-map", 2, 6, "hybrid_pcf"),
        // bench_with in two viewports.
        ("ms-trace-rays-by-map", 2, 8, "crsm"),
        ("ms-steps-by-map", 2, 12, "nsm"),
        ("fps-by-map", 2, 12, "crsm"),
    ] {
        let file = folder.path().join("charts").join(format!("{name}.svg"));
        let svg = fs::read_to_string(file).unwrap();
        assert_eq!(svg.matches("\nD: park, ").count(), pairs, "{name}");
        assert_eq!(svg.matches("\nours: park, ").count(), pairs, "{name}");
        let drawn = svg.matches("opacity=\"0.45\"").count();
        assert_eq!(drawn, 2 * bars, "{name}");
        assert!(svg.contains(&format!("\n{series}\n")), "{name}: {series}");
        assert!(!svg.contains("\ncrsm_depth\n"), "{name}");
    }
    // D has its shares of one map there.
    let one = "chart with --beside D:d.csv --size 16x16 --out one";
    let output = skiagraph(folder.path(), one);
    let told = String::from_utf8_lossy(&output.stderr);
    assert!(
        told.contains("not drawn: uncertain_percent: no two map sizes or viewports"),
        "{told}"
    );
}

#[test]
#[ignore = "a suite: `./test.sh --all` runs it"]
fn results_of_other_conditions_are_not_resumed() {
    let folder = tempfile::tempdir().unwrap();
    let compare = |rest: &str| {
        Command::new(env!("CARGO_BIN_EXE_skiagraph"))
            .args("compare nsm --size 8x8 --map-size 8 --warmup 0 --out .".split(' '))
            .args(rest.split(' '))
            .current_dir(folder.path())
            .output()
            .unwrap()
    };
    let first = compare("--frames 1 --resume");
    let text = String::from_utf8_lossy(&first.stderr);
    assert!(text.contains("./results.json is not there yet"), "{text}");
    let before = results(folder.path());
    let other = compare("--frames 2 --resume");
    let text = String::from_utf8_lossy(&other.stderr);
    assert_eq!(other.status.code(), Some(1), "{text}");
    assert!(text.contains("frames: there 1, here 2"), "{text}");
    assert_eq!(results(folder.path()), before);
    assert_eq!(compare("--frames 2").status.code(), Some(1), "nor lost");
    assert_eq!(results(folder.path()), before);
    assert_eq!(compare("--frames 2 --replace").status.code(), Some(0));
    assert_eq!(results(folder.path())["frames"], 2);
}

#[test]
fn what_could_not_run_is_tried_again() {
    let folder = tempfile::tempdir().unwrap();
    // One is for Windows, one for Android: no adapter has both.
    let nowhere = LIT.replace(
        "format: 3,",
        r#"format: 3, requires: [
            "VULKAN_EXTERNAL_MEMORY_WIN32",
            "VULKAN_GOOGLE_DISPLAY_TIMING",
        ],"#,
    );
    fs::write(folder.path().join("nowhere.ron"), nowhere).unwrap();
    let compare = || {
        let line = "compare nsm nowhere.ron --size 8x8 --map-size 8 --frames 1 --out . --resume";
        let output = skiagraph(folder.path(), line);
        String::from_utf8_lossy(&output.stderr).into_owned()
    };
    compare();
    let before = results(folder.path());
    assert!(
        before["runs"][1]["unavailable"].is_string(),
        "{}",
        before["runs"][1]
    );
    let text = compare();
    assert!(
        text.contains("1 of 2 runs are kept") && !text.contains("starting"),
        "{text}"
    );
    let again = results(folder.path());
    assert_eq!(again["runs"], before["runs"]);
    assert_eq!(timeless(again), timeless(before));
}

#[test]
fn poison_finds_what_reads_memory_that_nothing_wrote() {
    let folder = tempfile::tempdir().unwrap();
    for preset in ["rt", "nsm"] {
        let output = skiagraph(
            folder.path(),
            &format!("run {preset} --size 64x48 --poison"),
        );
        let text = String::from_utf8_lossy(&output.stdout);
        assert!(text.contains("no output depends"), "{preset}:\n{text}");
    }
    // A promise that does not hold: every second row stays as it was.
    let careless = LIT.replace(
        "Clear(name: \"light\", target: \"visibility\", value: 1),",
        "Compute(name: \"rows\", dispatch: Over(\"visibility.size\"), overwrites: \
         [\"visibility\"]),",
    );
    let careless = careless.replace(
        "name: \"visibility\", format: R8Uint",
        "name: \"visibility\", format: R32Uint",
    );
    let shader = "var visibility: texture_storage_2d<r32uint, write>;
        @compute @workgroup_size(8, 8) fn main(@builtin(global_invocation_id) id: vec3<u32>) {
            if id.y % 2u == 0u { textureStore(visibility, id.xy, vec4(1u)); }
        }";
    fs::write(folder.path().join("careless.ron"), careless).unwrap();
    fs::write(folder.path().join("rows.wgsl"), shader).unwrap();
    let output = Command::new(env!("CARGO_BIN_EXE_skiagraph"))
        .args(["run", "careless.ron", "--size", "64x48", "--poison"])
        .current_dir(folder.path())
        .output()
        .unwrap();
    let text = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{text}");
    assert!(
        text.contains("`visibility` (50.000 % of its bytes)") && !text.contains("`status`"),
        "{text}"
    );
}

#[test]
fn poison_does_not_take_the_order_of_threads_for_memory_that_nothing_wrote() {
    let folder = tempfile::tempdir().unwrap();
    let racing = LIT
        .replace(
            "materials: [",
            "materials: [Buffer(name: \"turns\", count: 262144), Buffer(name: \"next\"),",
        )
        .replace(
            "passes: [",
            "passes: [Clear(name: \"first\", target: \"next\"),
             Compute(name: \"take_turns\", dispatch: Over(\"turns.count\"), \
             overwrites: [\"turns\"]),",
        )
        .replace("outputs: [", "outputs: [\"turns\", ");
    let shader = "var<storage, read_write> next: atomic<u32>;
        var<storage, read_write> turns: array<u32>;
        @compute @workgroup_size(64) fn main(@builtin(global_invocation_id) id: vec3<u32>) {
            turns[atomicAdd(&next, 1u)] = id.x;
        }";
    fs::write(folder.path().join("racing.ron"), racing).unwrap();
    fs::write(folder.path().join("take_turns.wgsl"), shader).unwrap();
    let output = skiagraph(folder.path(), "run racing.ron --size 64x48 --poison");
    let text = String::from_utf8_lossy(&output.stdout);
    assert!(text.contains("no output depends"), "{text}");
}
