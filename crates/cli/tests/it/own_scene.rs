//! Mesh files of one's own, as the program takes them: their cameras and lights, and what is chosen
//! for a file that has none.

use crate::support::{results, skiagraph};
use serde_json::Value;
use std::{fs, path::Path};
use tempfile::TempDir;

/// A folder with the files of `own_scene/`.
fn folder() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    let files = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/it/own_scene"));
    for file in fs::read_dir(files).unwrap() {
        let file = file.unwrap();
        fs::copy(file.path(), folder.path().join(file.file_name())).unwrap();
    }
    folder
}

/// Notes of the program on a scene before it is drawn.
fn said(folder: &TempDir, arguments: &str) -> String {
    let line = format!("run rt --size 32x32 --scene {arguments}");
    let output = skiagraph(folder.path(), &line);
    let text = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.success(), "{line}: {text}");
    text
}

/// Notes on the scene in the results of the last comparison.
fn notes(folder: &TempDir) -> Vec<String> {
    let text = fs::read_to_string(folder.path().join("out/results.json")).unwrap();
    let results: Value = serde_json::from_str(&text).unwrap();
    serde_json::from_value(results["notes"].clone()).unwrap()
}

const COMPARE: &str = "compare rt --size 64x48 --frames 1 --warmup 0 --images none --out out";

#[test]
fn cameras_and_lights_of_a_file_are_taken_by_name() {
    let folder = folder();
    let expected = [
        "room.gltf: its cameras, for --view: door_cam; its lights, for --light: ceiling_lamp, \
         torch",
        "room.gltf: the mesh is 8 units wide (x), 3 high (y) and 6 deep (z), right-handed; if z is \
         up, give --up 0,0,1",
        "room.gltf:",
        "  node 4 \"Top\": its camera is left out: it is orthographic, and views are perspective \
         (make it perspective, or give --eye and --look)",
        "  node 7 \"Off\": its light is left out: its intensity is 0: it lights nothing, give it \
         more than 0",
    ];
    assert_eq!(said(&folder, "room.gltf").trim_end(), expected.join("\n"));
    let line = format!("{COMPARE} --scene room.gltf --view all --light all");
    let (runs, _) = results(folder.path(), &line);
    let views: Vec<&str> = runs
        .iter()
        .map(|run| run["view"].as_str().unwrap())
        .collect();
    assert_eq!(views, ["door_cam@ceiling_lamp", "door_cam@torch"]);
    let output = skiagraph(
        folder.path(),
        "run rt --size 32x32 --scene room.gltf --view top",
    );
    let text = String::from_utf8_lossy(&output.stderr);
    assert!(
        text.contains("the scene `room` has no view `top`"),
        "{text}"
    );
    let notes = notes(&folder);
    assert_eq!(notes.len(), 4, "{notes:?}");
    assert!(notes[3].starts_with("node 7 \"Off\": its light is left out"));
    // A camera of one's own beside the lights of the file.
    let own = said(&folder, "room.gltf --eye 0,1,2 --light torch");
    assert!(!own.contains("chosen"), "{own}");
}

#[test]
fn a_room_without_a_camera_is_seen_from_inside() {
    let folder = folder();
    let line = format!("{COMPARE} --scene bare_room.gltf");
    let (runs, _) = results(folder.path(), &line);
    assert_eq!(runs[0]["view"], "inside");
    let pixels = &runs[0]["pixels"];
    assert_eq!(pixels["background"], 0);
    assert!(pixels["lit"].as_u64() > Some(300), "{pixels}");
    assert!(pixels["shadow"].as_u64() > Some(300), "{pixels}");
    let text = said(&folder, "bare_room.gltf");
    let notes = notes(&folder);
    let printed = notes.iter().map(|note| format!("bare_room.gltf: {note}\n"));
    assert_eq!(
        printed.collect::<String>(),
        text,
        "results keep what is printed"
    );
    let chosen = "it holds no camera and no light; chosen `inside`, from inside, for there is a \
                  place to stand: --eye ";
    assert!(text.contains(chosen), "{text}");
    assert!(text.contains(" and a lamp at "), "{text}");
    // A sun that is asked for shines, though not into the room.
    let sun = said(&folder, "bare_room.gltf --light 0,-1,0 --up 0,1,0");
    assert!(!sun.contains("lamp"), "{sun}");
    assert!(
        sun.contains("the mesh is 8 × 3 × 6 units (x, y, z), right-handed, with 0,1,0 up"),
        "{sun}"
    );
}

#[test]
fn a_town_is_compared_from_a_street_and_from_outside() {
    let folder = folder();
    let mut text = String::from("v -9 0 -9\nv -9 0 90\nv 90 0 90\nv 90 0 -9\nf 1 2 3 4\n");
    let corners = "f -8 -7 -5 -6\nf -4 -2 -1 -3\nf -8 -4 -3 -7\nf -6 -5 -1 -2\nf -8 -6 -2 -4\n\
                   f -7 -3 -1 -5\n";
    for house in 0..16 {
        let (x, z) = (f64::from(house % 4) * 22.0, f64::from(house / 4) * 22.0);
        for corner in 0..8 {
            let at = |bit: i32, size: f64| if corner >> bit & 1 == 1 { size } else { 0.0 };
            text += &format!("v {} {} {}\n", x + at(0, 10.0), at(2, 8.0), z + at(1, 11.0));
        }
        text += corners;
    }
    fs::write(folder.path().join("town.obj"), text).unwrap();
    let (runs, _) = results(folder.path(), &format!("{COMPARE} --scene town.obj"));
    let views = runs.iter().map(|run| run["view"].as_str().unwrap());
    assert_eq!(views.collect::<Vec<_>>(), ["street", "main"]);
    for run in &runs {
        let pixels = &run["pixels"];
        let [lit, shadow] = ["lit", "shadow"].map(|class| pixels[class].as_f64().unwrap());
        assert!(lit.min(shadow) > 0.03 * (lit + shadow), "{pixels}");
    }
    let stderr = said(&folder, "town.obj");
    assert!(
        stderr.contains("`street`, in a street, 1.7 units above the floor"),
        "{stderr}"
    );
    assert!(!stderr.contains("no floor"), "{stderr}");
    assert!(
        stderr.contains("; `compare` takes all of them, --view one"),
        "{stderr}"
    );
    let (runs, _) = results(
        folder.path(),
        &format!("{COMPARE} --replace --scene town.obj --view main"),
    );
    assert_eq!(runs.len(), 1);
}

#[test]
fn a_view_may_look_along_its_up() {
    let folder = folder();
    let plain = "v -4 0 -4\nv -4 0 4\nv 4 0 4\nv 4 0 -4\nf 1 2 3 4\n\
                 v -1 2 -1\nv -1 2 1\nv 1 2 1\nv 1 2 -1\nf 5 6 7 8\n";
    fs::write(folder.path().join("plain.obj"), plain).unwrap();
    for look in [
        "0,-1,0",
        "0,-1,1e-12",
        "0,0,-1 --up 0,0,1 --eye 0,1,9",
        "0,-2,0 --eye 0,9,0",
    ] {
        let line = format!("{COMPARE} --replace --scene plain.obj --look {look}");
        let (runs, _) = results(folder.path(), &line);
        assert_eq!(runs[0]["counts"]["wrong"].as_u64().unwrap_or(0), 0);
        let pixels = &runs[0]["pixels"];
        if !look.contains("--up") {
            assert!(pixels["lit"].as_u64() > Some(300), "{look}: {pixels}");
            assert!(pixels["shadow"].as_u64() > Some(20), "{look}: {pixels}");
        }
    }
}

#[test]
fn settings_are_chosen_on_other_views_than_that_of_an_eye() {
    let folder = folder();
    let tune = COMPARE.replace("compare rt", "compare nsm --tune --replace");
    for scene in [
        "objects.gltf --eye 2,2,2 --look -1,-0.8,-1",
        "objects.gltf --eye 2,2,2 --look -1,-0.8,-1 --view main",
        "room.gltf --eye 1,1.5,2 --light ceiling_lamp",
    ] {
        let (runs, table) = results(folder.path(), &format!("{tune} --scene {scene}"));
        assert!(!table.contains("0 views"), "{scene}: {table}");
        let chosen_on = runs
            .iter()
            .flat_map(|run| run["tuned"]["chosen_on"].as_array());
        let chosen_on: Vec<&Value> = chosen_on.flatten().collect();
        assert!(!chosen_on.is_empty(), "{scene}");
        assert!(
            runs.iter().all(|run| !chosen_on.contains(&&run["view"])),
            "{chosen_on:?}"
        );
    }
}

#[test]
fn a_view_with_hardly_any_shadow_is_told() {
    let folder = folder();
    let line = format!("{COMPARE} --scene objects.gltf --light 0,-1,0");
    let output = skiagraph(folder.path(), &line);
    let text = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{text}");
    assert!(
        text.contains("warning: view `main` shows hardly any shadow: 0 of the "),
        "{text}"
    );
    let floor = "objects.gltf: it has no floor for its shadow to fall on; --ground adds one";
    assert!(text.contains(floor), "{text}");
    assert!(
        text.contains("look from another side, or move the light"),
        "{text}"
    );
}

#[test]
fn a_chosen_scene_is_written_and_is_the_same_again() {
    let folder = folder();
    let line = format!("{COMPARE} --scene objects.gltf --ground --write-scene table.ron");
    let output = skiagraph(folder.path(), &line);
    let text = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{text}");
    let placed = "objects.gltf: a ground was added, a square of 7.12 units at the height \
                  -0.00023748685, just below the lowest point";
    assert!(text.contains(placed), "{text}");
    let wrote = "wrote table.ron, to be edited (docs/scenes.md); use it with --scene table.ron";
    assert!(text.contains(wrote), "{text}");
    let (first, _) = results(folder.path(), &line);
    let (again, _) = results(
        folder.path(),
        &format!("{COMPARE} --replace --scene table.ron"),
    );
    assert_eq!(first[0]["view"], again[0]["view"]);
    assert_eq!(first[0]["pixels"], again[0]["pixels"]);
    // The same once more is left as it is; another scene does not take its place.
    said(&folder, "objects.gltf --ground --write-scene table.ron");
    for (rest, expected) in [
        (
            "room.gltf --write-scene table.ron",
            "--write-scene table.ron: it is there already and says something else; name another \
             file, or delete it",
        ),
        (
            "room.gltf --write-scene room.txt",
            "--write-scene room.txt: a scene file is called NAME.ron",
        ),
        (
            "room.gltf --write-scene no/folder/room.ron",
            "--write-scene no/folder/room.ron: no/folder: ",
        ),
        ("park --ground", "so leave them out with --scene park"),
    ] {
        let output = skiagraph(
            folder.path(),
            &format!("run rt --size 32x32 --scene {rest}"),
        );
        let text = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{text}");
        assert!(text.contains(expected), "{text}");
    }
    // A floor of one's own is enough.
    let room = said(&folder, "bare_room.gltf --ground");
    assert!(
        room.contains("--ground adds none, for the mesh has a floor"),
        "{room}"
    );
}

#[test]
fn a_written_scene_keeps_views_and_paths_and_names_its_mesh_from_its_folder() {
    let folder = folder();
    fs::create_dir(folder.path().join("scenes")).unwrap();
    said(
        &folder,
        "park --view trees_side --fov 30 --write-scene mine.ron",
    );
    let text = fs::read_to_string(folder.path().join("mine.ron")).unwrap();
    assert!(text.contains("mesh: Generated(\"park\")"), "{text}");
    assert!(
        text.contains("    views: [\n        (name: \"own\""),
        "{text}"
    );
    assert!(text.contains("name: \"sunrise\""), "{text}");
    said(&folder, "mine.ron --view bench_side");
    // Beside the mesh, and elsewhere.
    said(&folder, "room.gltf --write-scene room.ron");
    let text = fs::read_to_string(folder.path().join("room.ron")).unwrap();
    assert!(text.contains("Gltf(file: \"room.gltf\")"), "{text}");
    said(&folder, "room.gltf --write-scene scenes/away.ron");
    said(&folder, "scenes/away.ron --light torch");
    said(&folder, "room.ron --light torch --write-scene again.ron");
    said(&folder, "again.ron");
}

#[test]
fn animations_of_a_file_are_paths() {
    let folder = folder();
    let text = said(&folder, "moving.gltf --write-scene moving.ron");
    let paths = "moving.gltf: its animations, for --path: walk, lamp_swings_lamp, lamp_swings_sun";
    assert!(text.contains(paths), "{text}");
    assert!(
        text.contains("export them sampled, with linear keys"),
        "{text}"
    );
    // The camera goes through the room while the door turns, in front of a knob that goes with it.
    let walk = |scene: &str| {
        let (runs, _) = results(
            folder.path(),
            &format!("{COMPARE} --replace --scene {scene} --path walk"),
        );
        assert_eq!(runs[0]["view"], "walk");
        let frames = runs[0]["sequence"]["frames"].as_array().unwrap();
        let counts = frames.iter().map(|frame| {
            assert_eq!(frame["wrong"], 0, "{frame}");
            [&frame["facing_light"], &frame["graded"]["soft"]["umbra"]].map(Value::as_u64)
        });
        counts.collect::<Vec<_>>()
    };
    let own = walk("moving.gltf");
    assert_eq!(own.len(), 61);
    // The door's shadow changes with its turn.
    assert_ne!(own[0][1], own[30][1]);
    assert_eq!(own, walk("moving.ron"));
    let output = skiagraph(
        folder.path(),
        &format!("{COMPARE} --replace --scene moving.gltf --path lamp_swings_lamp"),
    );
    let text = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{text}");
    let output = skiagraph(
        folder.path(),
        &format!("{COMPARE} --replace --scene moving.gltf --path lamp"),
    );
    let text = String::from_utf8_lossy(&output.stderr);
    assert!(text.contains("has no path `lamp`"), "{text}");
    // `run` takes them as well.
    let run = "run rt --size 32x32 --scene moving.gltf --path walk --frames 2 --save";
    let output = skiagraph(folder.path(), &format!("{run} visibility=walk.bin"));
    let text = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{text}");
    let frame = |file: &str| fs::read(folder.path().join(file)).unwrap();
    assert_ne!(frame("walk.0000.bin"), frame("walk.0001.bin"));
}
