//! Scene files that are written say what was read.

use proptest::prelude::*;
use skiagraph_scene::{SceneFile, SceneLibrary, scene_text};

fn written_and_read(scene: &SceneFile) -> SceneFile {
    let text = scene_text(scene).unwrap();
    SceneFile::parse(&text, "written.ron").unwrap_or_else(|error| panic!("{error}\n{text}"))
}

#[test]
fn every_built_in_scene_is_the_same_after_it_was_written() {
    let library = SceneLibrary::default();
    for listing in library.list() {
        let text = library.text(&listing.name).unwrap();
        let scene = SceneFile::parse(&text, &listing.name).unwrap();
        assert_eq!(
            format!("{:?}", written_and_read(&scene)),
            format!("{scene:?}")
        );
    }
    let lamps = include_str!("../../scenes/lamps.ron");
    let scene = SceneFile::parse(lamps, "lamps.ron").unwrap();
    assert_eq!(
        format!("{:?}", written_and_read(&scene)),
        format!("{scene:?}")
    );
}

const TABLE: &str = include_str!("scene_writer/table.ron");

#[test]
fn a_written_file_is_laid_out_for_an_editor() {
    let scene = SceneFile::parse(TABLE, "table.ron").unwrap();
    assert_eq!(scene_text(&scene).unwrap(), TABLE);
}

#[test]
fn a_path_under_a_lamp_of_the_scene_says_the_option() {
    let mut scene = SceneFile::parse(TABLE, "table.ron").unwrap();
    scene.paths[0].view.light = scene.lights.first().cloned();
    let text = scene_text(&scene).unwrap();
    let comment = "        // Under its light: --light bulb\n        (\n";
    assert!(text.contains(comment), "{text}");
    SceneFile::parse(&text, "table.ron").unwrap();
}

#[test]
fn a_lamp_of_a_view_cannot_be_written() {
    let mut scene = SceneFile::parse(TABLE, "table.ron").unwrap();
    scene.views[0].light = scene.lights.first().cloned();
    assert_eq!(
        scene_text(&scene).unwrap_err(),
        "\"main\" has a point light of its own, and a scene file has such lights for all views only"
    );
}

#[test]
fn a_ground_needs_a_direction() {
    let text = TABLE.replace("ground: (0, 0, 1)", "ground: (0, 0, 0)");
    let error = SceneFile::parse(&text, "table.ron").unwrap_err();
    let error = error.to_string();
    assert!(
        error.contains("expected a direction up, such as (0, 1, 0)"),
        "{error}"
    );
}

proptest! {
    #[test]
    fn numbers_and_names_are_read_to_the_last_bit(
        x in proptest::num::f64::NORMAL,
        name in ".{1,20}",
    ) {
        let mut scene = SceneFile::parse(TABLE, "table.ron").unwrap();
        let x = if x.abs() < 1e15 { x } else { 0.1 / x };
        scene.views[0].eye.x = x;
        scene.views[0].name.clone_from(&name);
        prop_assume!(scene.views[0].check().is_ok());
        let read = written_and_read(&scene);
        prop_assert_eq!(read.views[0].eye.x, x);
        prop_assert_eq!(&read.views[0].name, &name);
    }
}
