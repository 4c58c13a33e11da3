//! Scene files, and how scenes and their meshes are found.

use insta::assert_snapshot;
use skiagraph_located_ron::diagnostics::{Diagnostic, Diagnostics};
use skiagraph_scene::{SceneError, SceneFile, SceneLibrary};
use std::{fs, path::Path};

const GOOD: &str = r#"(
    format: 1,
    name: "garden",
    mesh: Generated("park"),
    light: (direction: (0, -1, 0)),
    views: [
        (name: "a", eye: (0, 5, 0), direction: (0, 0, 1), fov_y_degrees: 60, near: 1, far: 100),
    ],
)"#;

fn found(text: &str) -> Diagnostics {
    match SceneFile::parse(text, "garden.ron") {
        Err(SceneError::SceneFile(diagnostics)) => diagnostics,
        other => panic!("{other:?}"),
    }
}

/// A line per mistake.
fn told(text: &str) -> String {
    let lines: Vec<String> = found(text).iter().map(Diagnostic::brief).collect();
    lines.join("\n")
}

fn with(from: &str, to: &str) -> String {
    assert!(GOOD.contains(from), "{from}");
    GOOD.replace(from, to)
}

fn error(from: &str, to: &str) -> String {
    told(&with(from, to))
}

/// The mistakes that are made most, with the lines that they are about.
#[test]
fn mistakes_are_shown_in_their_lines() {
    let view = GOOD.lines().nth(6).unwrap();
    let frames = [
        ("near: 1", "naer: 1"),
        ("Generated(", "Genrated("),
        ("mesh: Generated(\"park\")", "mesh: Obj(fiel: \"a.obj\")"),
        ("Generated(\"park\")", "Generated(\"parc\")"),
        ("fov_y_degrees: 60", "fov_y_degrees: \"wide\""),
        ("(0, 5, 0)", "(0, 5)"),
        ("(direction: (0, -1, 0))", "(angle_degrees: 1)"),
        ("fov_y_degrees: 60, ", ""),
        ("mesh: Generated(\"park\"),", ""),
        ("near: 1,", "near: 200,"),
        ("near: 1,", "near 1,"),
        ("    ],\n)", "    ],"),
        ("light: (", "light: Sun("),
        (view, ""),
        (view, &format!("{view}\n{view}")),
        ("format: 1", "format: 2"),
        ("light: (", "shadows: {\"lawn\": Cast},\n    light: ("),
        ("light: (", "shadows: [\"lawn\"],\n    light: ("),
    ]
    .map(|(from, to)| found(&with(from, to)).render(false));
    assert_snapshot!(frames.join("\n"));
}

#[test]
fn a_good_file() {
    let scene = SceneFile::parse(GOOD, "garden.ron").unwrap();
    assert_eq!(
        (scene.name.as_str(), scene.description.as_str()),
        ("garden", "")
    );
    assert_eq!(scene.views[0].up, glam::DVec3::Y);
    assert_eq!(
        scene.lights[0].kind.towards(glam::DVec3::ZERO).direction,
        glam::DVec3::Y
    );
    assert_eq!(scene.views[0].light, None);
}

#[test]
fn a_view_may_have_a_light_of_its_own() {
    let view = GOOD.lines().nth(6).unwrap();
    let own = view
        .replace("\"a\"", "\"b\"")
        .replace("far: 100", "far: 100, light: (direction: (0, 0, 2))");
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("garden.ron");
    fs::write(&file, GOOD.replace(view, &format!("{view}\n{own}"))).unwrap();
    let (scene, _) = SceneLibrary::default().load(&request(&file)).unwrap();
    let lights = ["a", "b"].map(|name| {
        scene
            .light_of(scene.view(name).unwrap())
            .towards(glam::DVec3::ZERO)
            .direction
    });
    assert_eq!(lights, [glam::DVec3::Y, glam::DVec3::NEG_Z]);
}

#[test]
fn broken_files_are_explained_with_line_and_column() {
    assert_snapshot!(error("near: 1", "naer: 1"), @"garden.ron:7:78: \
        unknown field `naer`");
    let own_light = |text: &str| error("far: 100", &format!("far: 100, light: ({text})"));
    assert_snapshot!(own_light("direction: (0, 0, 0)"), @"garden.ron:7:9: view \
        \"a\": the light's direction [0, 0, 0] must be finite and longer than 0");
    assert_snapshot!(own_light("towards: (0, 1, 0)"), @"garden.ron:7:105: \
        unknown field `towards`");
    assert_snapshot!(error("name: \"garden\",", ""), @"garden.ron:1:1: the \
        field `name` is missing");
    assert_snapshot!(error("format: 1", "format: 2"), @"garden.ron:2:13: format 2 is unknown; \
        this program reads format 1");
    assert_snapshot!(error("\"park\"", "\"parc\""), @"garden.ron:4:11: no \
        generated mesh is called \"parc\"; there are: park, avenue, level, \
        city:TRIANGLES, forest:TRIANGLES");
    assert_snapshot!(error("Generated(", "Made("), @"garden.ron:4:11: \
        unknown word `Made`");
    assert_snapshot!(error("(0, -1, 0)", "(0, -1)"), @"garden.ron:5:29: 3 \
        values are needed here, not 2");
    assert_snapshot!(error("(0, -1, 0)", "(0, 0, 0)"), @"garden.ron:5:12: the \
        light's direction [0, 0, 0] must be finite and longer than 0");
    assert_snapshot!(error("(0, -1, 0)", "(0, -1, 0), angle_degrees: 90"), @"garden.ron:5:12: the \
        light's angle_degrees is 90; expected at least 0 and less than 90, the angle that \
        it takes up in the sky; several lights stand for a wider one");
    assert_snapshot!(own_light("direction: (0, 1, 0), angle_degrees: -1"), @"garden.ron:7:9: view \
        \"a\": the light's angle_degrees is -1; expected at least 0 and less than 90, the \
        angle that it takes up in the sky; several lights stand for a wider one");
    let sun = "lights: [Directional(name: \"sun\", direction: (0, -1, 0), angle_degrees: NaN)]";
    assert_snapshot!(error("light: (direction: (0, -1, 0))", sun), @"garden.ron:5:14: light \
        \"sun\": the light's angle_degrees is NaN; expected at least 0 and less than 90, the \
        angle that it takes up in the sky; several lights stand for a wider one");
    assert_snapshot!(error("direction: (0, 0, 1)", "direction: (0, NaN, 1)"),
        @"garden.ron:7:9: view \
        \"a\": direction [0, NaN, 1] and up [0, 1, 0] must be finite and longer than 0");
    assert_snapshot!(error("fov_y_degrees: 60", "fov_y_degrees: 180"), @"garden.ron:7:9: view \
        \"a\": fov_y_degrees is 180, expected more than 0 and less than 180");
    assert_snapshot!(error("near: 1,", "near: 0,"), @"garden.ron:7:9: view \
        \"a\": near is 0 and far is 100, expected 0 < near < far");
    assert_snapshot!(error("far: 100", "far: 1"), @"garden.ron:7:9: view \
        \"a\": near is 1 and far is 1, expected 0 < near < far");
    assert_snapshot!(error("(0, 5, 0)", "(0, inf, 0)"), @"garden.ron:7:9: view \
        \"a\": the eye [0, inf, 0] is not finite");
    assert_snapshot!(error("    ],\n)", "    ],"), @"garden.ron:1:1: `(` is not closed");
    let view = GOOD.lines().nth(6).unwrap();
    assert_snapshot!(error(view, ""), @"garden.ron:6:12: \
        `views` is empty; a scene needs one");
    assert_snapshot!(error(view, &format!("{view}\n{view}")), @"garden.ron:8:9: two \
        views are called \"a\"");
}

#[test]
fn every_mistake_of_a_file_is_told() {
    let text = r#"(
    format: 1,
    nam: "garden",
    mesh: Generated("parc"),
    light: (direction: (0, -1)),
    views: [
        (name: "a", eye: (0, 5), directoin: (0, 0, 1), fov_y_degrees: wide, near: 1, far: 100),
        (name: "b", eye: (0, 5, 0), direction: (0, 0, 1), near: 1, far: 100),
        // a comment, and a view that is right
        (name: "c", eye: (0, 5, 0), direction: (0, 0, 1), fov_y_degrees: 9, near: 1, far: 9),
        (name: "d", eye: (0, 5, 0), direction: (0, 0, 0), fov_y_degrees: 9, near: 1, far: 9),
    ],
    paths: walk,
)"#;
    let report = told(text);
    let lines: Vec<&str> = report
        .lines()
        .map(|line| &line["garden.ron:".len()..])
        .collect();
    let expected = [
        "3:5: unknown field `nam`",
        "4:11: no generated mesh is called \"parc\"; there are: park, avenue, level, \
            city:TRIANGLES, forest:TRIANGLES",
        "5:29: 3 values are needed here, not 2",
        "7:30: 3 values are needed here, not 2",
        "7:34: unknown field `directoin`",
        "7:71: a number is needed",
        "8:9: the field `fov_y_degrees` is missing",
        "11:9: view \"d\": direction [0, 0, 0] and up [0, 1, 0] must be finite and \
            longer than 0",
        "13:12: a list `[a, b]` is needed",
    ];
    assert_eq!(lines, expected);
}

const LAMPS: &str = r#"lights: [
        Directional(name: "sun", direction: (0, -1, 0), angle_degrees: 0.53),
        Spot(name: "lamp", position: (1, 5, 0), direction: (0, -1, 0),
            cone_degrees: 60, radius: 0.2),
        Point(name: "bulb", position: (1, 2, 3)),
    ]"#;

#[test]
fn a_scene_may_have_several_lights() {
    let text = GOOD.replace("light: (direction: (0, -1, 0))", LAMPS);
    let scene = SceneFile::parse(&text, "garden.ron").unwrap();
    let lights: Vec<_> = scene
        .lights
        .iter()
        .map(|light| (light.name.as_str(), light.kind.word()))
        .collect();
    let expected = [("sun", "directional"), ("lamp", "spot"), ("bulb", "point")];
    assert_eq!(lights, expected);
    let bulb = scene.lights[2]
        .kind
        .towards(glam::DVec3::new(1.0, 2.0, 1.0));
    assert_eq!((bulb.direction, bulb.distance), (glam::DVec3::Z, 2.0));
}

#[test]
fn broken_lights_are_explained() {
    let good = GOOD.replace("light: (direction: (0, -1, 0))", LAMPS);
    let wrong = |from: &str, to: &str| {
        assert!(good.contains(from), "{from}");
        told(&good.replace(from, to))
    };
    let sun = "light: (direction: (0, -1, 0)),";
    let without = error(sun, "");
    assert!(
        without.contains("a scene needs a `light`, or `lights`"),
        "{without}"
    );
    let both = error(sun, &format!("{LAMPS}, {sun}"));
    assert!(both.contains("not both"), "{both}");
    let empty = error(sun, "lights: [],");
    assert!(empty.contains("`lights` is empty"), "{empty}");
    for (from, to, says) in [
        ("\"bulb\"", "\"lamp\"", "two lights are called \"lamp\""),
        (
            "\"bulb\"",
            "\"Bulb 2\"",
            "expected small letters, digits and `_`",
        ),
        ("\"bulb\"", "\"all\"", "which means all lights"),
        (
            "cone_degrees: 60",
            "cone_degrees: 180",
            "light \"lamp\": cone_degrees is 180",
        ),
        (
            "cone_degrees: 60",
            "cone_degrees: 0",
            "light \"lamp\": cone_degrees is 0",
        ),
        ("cone_degrees: 60, ", "", "`cone_degrees`"),
        ("radius: 0.2", "radius: -1", "light \"lamp\": radius is -1"),
        (
            "0), direction: (0, -1, 0)",
            "0), direction: (0, 0, 0)",
            "longer than 0",
        ),
        (
            "(1, 2, 3)",
            "(1, inf, 3)",
            "light \"bulb\": the light's position",
        ),
        ("Point(", "Bulb(", "`Bulb`"),
    ] {
        let message = wrong(from, to);
        assert!(message.contains(says), "{message}");
        assert!(message.starts_with("garden.ron:"), "{message}");
    }
}

fn request(argument: impl AsRef<Path>) -> String {
    argument.as_ref().to_string_lossy().into_owned()
}

#[test]
fn the_park_is_built_in() {
    let (scene, _) = SceneLibrary::default().load(&request("park")).unwrap();
    assert_eq!(scene.name, "park");
    let names: Vec<&str> = scene.views.iter().map(|view| view.name.as_str()).collect();
    let expected: Vec<String> = ["bench", "flowers", "trees"]
        .iter()
        .flat_map(|place| ["side", "with", "against"].map(|way| format!("{place}_{way}")))
        .collect();
    assert_eq!(names, expected);
    assert!(scene.view("trees_with").is_some() && scene.view("trees").is_none());
}

#[test]
fn a_file_in_the_scenes_folder_wins_over_the_built_in_scene() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("park.ron"), GOOD).unwrap();
    let library = SceneLibrary {
        scenes: folder.path().to_owned(),
        assets: Vec::new(),
    };
    assert_eq!(library.load(&request("park")).unwrap().0.name, "garden");
    assert_eq!(
        library
            .load(&request(folder.path().join("park.ron")))
            .unwrap()
            .0
            .name,
        "garden"
    );
    let listed: Vec<_> = library
        .list()
        .into_iter()
        .map(|row| (row.name, row.mesh_found, row.file.is_some()))
        .collect();
    assert_eq!(
        listed,
        [
            ("avenue".to_owned(), true, false),
            ("bench".to_owned(), false, false),
            ("city".to_owned(), true, false),
            ("forest".to_owned(), true, false),
            ("level".to_owned(), true, false),
            ("park".to_owned(), true, true),
            ("park_soft".to_owned(), true, false),
            ("sponza".to_owned(), false, false),
            ("sponza_masked".to_owned(), false, false)
        ]
    );
}

#[test]
fn a_broken_file_is_listed_with_its_fault() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("bad.ron"), "(format: 7)").unwrap();
    let library = SceneLibrary {
        scenes: folder.path().to_owned(),
        assets: Vec::new(),
    };
    let listed = library.list();
    let bad = listed.iter().find(|row| row.name == "bad").unwrap();
    assert_snapshot!(bad.description, @"bad:1:10: format 7 is unknown; this program \
        reads format 1");
}

#[test]
fn unknown_scenes_and_missing_files() {
    let library = SceneLibrary {
        scenes: "scenes".into(),
        assets: Vec::new(),
    };
    assert_snapshot!(library.load(&request("parc")).unwrap_err(), @"no scene \"parc\": it is \
        neither the path of a .ron, .obj, .gltf or .glb file, nor the name of a .ron file in \
        scenes, nor one of the built-in scenes avenue, bench, city, forest, level, park, \
        park_soft, sponza, sponza_masked");
    assert!(matches!(
        library.load(&request("nowhere/parc.ron")),
        Err(SceneError::Read { .. })
    ));
}

const TRIANGLE: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
const WITH_MESH: &str = r#"Obj(file: "m/t.obj", source: "the attic")"#;

#[test]
fn meshes_are_searched_beside_the_scene_file_first() {
    let (own, assets) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    let scene = own.path().join("s.ron");
    fs::write(&scene, GOOD.replace(r#"Generated("park")"#, WITH_MESH)).unwrap();
    let library = SceneLibrary {
        scenes: own.path().to_owned(),
        assets: vec!["nowhere".into(), assets.path().to_owned()],
    };

    let missing = library.load(&request(&scene)).unwrap_err().to_string();
    let missing = missing
        .replace(&own.path().display().to_string(), "OWN")
        .replace(&assets.path().display().to_string(), "ASSETS");
    assert_snapshot!(missing.replace('\\', "/"), @r#"
    the mesh "m/t.obj" of scene "garden" was not found; searched
      OWN/m/t.obj
      nowhere/m/t.obj
      ASSETS/m/t.obj
    it can be downloaded: the attic
    put it at "m/t.obj" below a folder that the environment variable SKIAGRAPH_ASSETS names
    "#);
    assert!(
        !library
            .list()
            .iter()
            .any(|row| row.name == "s" && row.mesh_found)
    );

    for (folder, rows) in [(&assets, 1), (&own, 2)] {
        fs::create_dir(folder.path().join("m")).unwrap();
        fs::write(
            folder.path().join("m/t.obj"),
            format!("{TRIANGLE}{}", "f 3 2 1\n".repeat(rows - 1)),
        )
        .unwrap();
        assert_eq!(
            library
                .load(&request(&scene))
                .unwrap()
                .0
                .mesh
                .triangles
                .len(),
            rows
        );
    }
    assert!(
        library
            .list()
            .iter()
            .any(|row| row.name == "s" && row.mesh_found)
    );
}

#[test]
fn a_mesh_of_ones_own_has_no_source_and_a_folder_is_no_mesh() {
    let folder = tempfile::tempdir().unwrap();
    let scene = folder.path().join("s.ron");
    let library = SceneLibrary::default();
    let error = |mesh: &str| {
        fs::write(&scene, GOOD.replace(r#"Generated("park")"#, mesh)).unwrap();
        let error = library.load(&request(&scene)).unwrap_err().to_string();
        error
            .replace(&folder.path().display().to_string(), "OWN")
            .replace('\\', "/")
    };
    assert_snapshot!(error(r#"Obj(file: "t.obj")"#), @r#"
    the mesh "t.obj" of scene "garden" was not found; searched
      OWN/t.obj
    put it at "t.obj" below a folder that the environment variable SKIAGRAPH_ASSETS names
    "#);
    fs::create_dir(folder.path().join("t.obj")).unwrap();
    assert_snapshot!(error(r#"Obj(file: "t.obj")"#), @"the mesh of scene \"garden\": OWN/t.obj is \
        a folder, expected an .obj file");
    fs::write(folder.path().join("u.obj"), TRIANGLE).unwrap();
    assert_snapshot!(error(r#"Obj(file: "u.obj", leave_out: ["roof"])"#), @"OWN/u.obj: there is no \
        group \"roof\" to leave out; the file has no groups");
    fs::write(
        &scene,
        GOOD.replace(r#"Generated("park")"#, r#"Obj(file: "u.obj")"#),
    )
    .unwrap();
    assert_eq!(library.load(&request(&scene)).unwrap().1.faces, 1);
}

#[test]
fn a_bare_obj_lacks_a_view_and_a_light() {
    let library = SceneLibrary::default();
    assert_snapshot!(library.load(&request("t.obj")).unwrap_err(), @"t.obj: it holds no camera \
        or no light: give --eye x,y,z --look x,y,z (direction) and --light x,y,z (the \
        direction in which the light travels); --fov DEGREES, --near and --far if the defaults do \
        not suit it");
}

#[test]
fn a_mesh_has_no_scene_file() {
    let error = SceneLibrary::default().scene_file("house.obj").unwrap_err();
    assert_snapshot!(error, @"\"house.obj\" is a mesh, which has no scene file: name a scene, or \
        the path of a .ron file");
}

#[test]
fn a_byte_order_mark_is_no_part_of_a_scene_file() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("garden.ron");
    for text in [format!("\u{feff}{SCENE_OF_PARK}"), SCENE_OF_PARK.to_owned()] {
        std::fs::write(&file, text).unwrap();
        let (scene, _) = SceneLibrary::default().load(&request(&file)).unwrap();
        assert_eq!(scene.name, "garden");
    }
}

const SCENE_OF_PARK: &str = r#"(
    format: 1, name: "garden", mesh: Generated("park"),
    light: (direction: (0, -1, 0)),
    views: [(name: "a", eye: (0, 5, 0), direction: (0, 0, 1), fov_y_degrees: 60, near: 1, far: 9)],
)"#;

#[test]
fn a_scene_file_that_stands_in_for_a_built_in_one_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let library = SceneLibrary {
        scenes: folder.path().to_owned(),
        assets: Vec::new(),
    };
    assert_eq!(library.stand_in("park"), None);
    let file = folder.path().join("park.ron");
    let (_, text) = library.locate("park").unwrap();
    std::fs::write(&file, &text).unwrap();
    assert_eq!(library.stand_in("park"), None);
    std::fs::write(&file, SCENE_OF_PARK).unwrap();
    assert_eq!(library.stand_in("park"), Some(file));
    std::fs::write(folder.path().join("garden.ron"), SCENE_OF_PARK).unwrap();
    assert_eq!(library.stand_in("garden"), None);
}

/// Loads a scene of these roles in shadows.
fn load_with(shadows: &str) -> Result<(skiagraph_scene::Scene, String), String> {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("garden.ron");
    let text = with("light: (", &format!("shadows: {shadows},\n    light: ("));
    fs::write(&file, text).unwrap();
    let loaded = SceneLibrary::default().load(file.to_str().unwrap());
    let plain = |text: String| text.replace(&format!("{}/", folder.path().display()), "");
    loaded
        .map(|(scene, report)| (scene, plain(report.to_string())))
        .map_err(|error| plain(error.to_string()))
}

#[test]
fn parts_get_their_roles_in_shadows() {
    use skiagraph_scene::Shadows::{Both, Neither, Receives};
    let (scene, report) = load_with("{\"lawn\": Receives, \"lamp\": Neither}").unwrap();
    assert_eq!(report, "");
    for group in &scene.mesh.groups {
        let expected = match group.name.as_str() {
            "lawn" => Receives,
            "lamp" => Neither,
            _ => Both,
        };
        let mut own = group.triangles.clone();
        assert!(own.all(|id| scene.mesh.surfaces.shadows(id) == expected));
    }
    assert_snapshot!(load_with("{\"lawm\": Receives, \"lamp\": Neither}").unwrap_err(), @r#"
    error[unknown-resource]: no part of the mesh is called "lawm"
      --> garden.ron:5:15 no such part
      help: did you mean `lawn`?
    "#);
    let names = [
        "lawn", "bench", "lamp", "planter", "flowers", "tree 1", "tree 2",
    ];
    let nothing = names.map(|name| format!("{name:?}: Receives")).join(", ");
    let (_, report) = load_with(&format!("{{{nothing}}}")).unwrap();
    let expected = "garden.ron:5:15: no part of the mesh casts a shadow, so that everything is \
                    lit: let one cast (`shadows` of a scene file, `casts` in the extras of a glTF \
                    file)\n";
    assert_eq!(report, expected);
}
