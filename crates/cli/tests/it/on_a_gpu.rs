//! `compare` and `run` for real. They need an adapter; a machine without one fails here with the
//! program's own advice.

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
fn compare_all_takes_the_presets_that_presets_lists() {
    let (folder, listed) = presets_on_disk();
    let line = "compare --all --size 8x8 --map-size 8 --frames 1 --warmup 0 --regime-frames 0 \
        --images none --out . --format json";
    let printed = skiagraph(folder.path(), line).stdout;
    let file = fs::read(folder.path().join("results.json")).unwrap();
    assert!(printed == file, "--format json prints the file");
    let results: Value = serde_json::from_slice(&printed).unwrap();
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
    let line = "stress --case box_on_floor --size 16x16 --map-size 8 --out out --format json";
    let output = Command::new(env!("CARGO_BIN_EXE_skiagraph"))
        .args(line.split_whitespace())
        .current_dir(folder.path())
        .output()
        .unwrap();
    let file = fs::read(folder.path().join("out/stress.json")).unwrap();
    assert!(output.stdout == file, "--format json prints the file");
    let stderr = String::from_utf8_lossy(&output.stderr);
    assert!(
        !stderr.contains("box_on_floor"),
        "quiet in a pipe: {stderr}"
    );
    let report: Value = serde_json::from_slice(&file).unwrap();
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
fn outputs_that_break_the_contract_are_an_error_at_the_end() {
    let folder = tempfile::tempdir().unwrap();
    let odd = LIT.replace("value: 2", "value: 7");
    fs::write(folder.path().join("odd.ron"), odd).unwrap();
    let output = Command::new(env!("CARGO_BIN_EXE_skiagraph"))
        .args("compare odd.ron nsm --size 16x16 --map-size 16 --frames 1 --out .".split(' '))
        .current_dir(folder.path())
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(1));
    let text = String::from_utf8_lossy(&output.stderr);
    assert!(text.contains("`odd.ron`"), "{text}");
    let results = results(folder.path());
    assert_eq!(preset_names(&results["runs"]), ["odd.ron", "nsm"]);
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

fn results(folder: &Path) -> Value {
    let text = fs::read_to_string(folder.join("results.json")).unwrap();
    serde_json::from_str(&text).unwrap()
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
    let chosen = "chosen `main`, from outside: --eye ";
    assert!(text.contains(chosen), "{text}");
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

/// A floor, a sheet above it whose front faces the light, and a box beside the sheet.
const SHEET_AND_BOX: &str = "
v -9 0 -9\nv -9 0 9\nv 9 0 9\nv 9 0 -9\nf 1 2 3 4
v -4 2 -1\nv -4 2 1\nv -2 2 1\nv -2 2 -1\nf 5 6 7 8
v 2 1 -1\nv 2 1 1\nv 4 1 1\nv 4 1 -1\nv 2 2 -1\nv 2 2 1\nv 4 2 1\nv 4 2 -1
f 12 11 10 9\nf 13 14 15 16\nf 9 10 14 13\nf 10 11 15 14\nf 11 12 16 15\nf 12 9 13 16
";

#[test]
#[ignore = "a suite: `./test.sh --all` runs it"]
fn a_document_holds_what_was_measured_and_needs_no_pictures() {
    let folder = tempfile::tempdir().unwrap();
    let line = "compare nsm rt --view all --size 16x16 --map-size 8 --frames 1 --regime-frames 0 \
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
    let expected = ["cells", "report.html", "results.csv", "results.json"];
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
