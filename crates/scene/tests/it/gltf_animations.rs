//! Animations of glTF files: where cameras, lights and meshes are in each frame, and what is said
//! of those that are not followed.

use glam::DVec3;
use insta::assert_snapshot;
use proptest::prelude::*;
use serde_json::{Value, json};
use skiagraph_scene::{
    CameraPath, Mesh, View,
    gltf::{GltfScene, parse_gltf_scene},
};
use std::f64::consts::FRAC_1_SQRT_2 as HALF;
use std::path::Path;

/// The file that the program is tested with: a room, a door with a knob, a camera, a lamp, a sun.
const MOVING: &str = include_str!("../../../cli/tests/it/own_scene/moving.gltf");

fn read(document: &Value) -> (Mesh, GltfScene) {
    let text = document.to_string();
    let read = parse_gltf_scene(
        text.as_bytes(),
        Path::new("moving.gltf"),
        Default::default(),
    );
    let (mesh, scene, _) = read.unwrap();
    (mesh, scene)
}

fn moving() -> Value {
    serde_json::from_str(MOVING).unwrap()
}

/// With other animations; `{"input", "output"}` are accessors of the file.
fn with(animations: Value) -> Value {
    let mut document = moving();
    document["animations"] = animations;
    document
}

fn paths(scene: &GltfScene) -> Vec<CameraPath> {
    let clips = scene.clips.iter();
    let paths = clips.flat_map(|clip| clip.paths(&scene.views, &scene.lights, &scene.views[0]));
    paths.collect::<Result<_, _>>().unwrap()
}

#[test]
fn a_camera_goes_and_a_door_turns_with_what_hangs_on_it() {
    let (mesh, scene) = read(&moving());
    let paths = paths(&scene);
    let names: Vec<&str> = paths.iter().map(|path| path.view.name.as_str()).collect();
    assert_eq!(names, ["walk", "lamp_swings_lamp", "lamp_swings_sun"]);
    let walk = &paths[0];
    assert_eq!(walk.frames(), 61);
    for (frame, eye) in [
        (0, [0.0, 1.7, 2.8]),
        (15, [0.5, 1.7, 2.4]),
        (30, [1.0, 1.7, 2.0]),
        (60, [1.0, 1.7, 1.0]),
    ] {
        let seen = walk.view(frame);
        assert!((seen.eye - DVec3::from(eye)).length() < 1e-6, "{seen:?}");
        assert_eq!((seen.direction, seen.up), (DVec3::NEG_Z, DVec3::Y));
    }
    let movable = walk.movable(&mesh).unwrap().unwrap();
    let corner = |frame, group: &str| {
        let moved = walk.shape(&movable, frame).unwrap();
        let group = moved
            .groups
            .iter()
            .find(|other| other.name == group)
            .unwrap();
        moved.corners(group.triangles.start)[0]
    };
    // The door's hinge is at x = 0.5; after two seconds it is open by 60 degrees.
    for (group, rest) in [("Door", [-0.5, 0.0, -0.05]), ("knob", [0.35, 0.95, 0.05])] {
        let hinge = DVec3::X * 0.5;
        let rest = DVec3::from(rest);
        assert!((corner(0, group) - (rest + hinge)).length() < 1e-6 || group == "knob");
        let at_rest = corner(0, group) - hinge;
        for (frame, degrees) in [(0, 0.0), (15, 15.0), (60, 60f64)] {
            let turned = glam::DQuat::from_rotation_y(degrees.to_radians()) * at_rest;
            let now = corner(frame, group);
            assert!(
                (now - hinge - turned).length() < 1e-5,
                "{group} {frame}: {now}"
            );
        }
    }
}

#[test]
fn a_lamp_jumps_from_step_to_step_while_the_camera_stands() {
    let (_, scene) = read(&moving());
    let paths = paths(&scene);
    let lamp = |frame| {
        let light = paths[1].view(frame).light.unwrap();
        light.kind.position().unwrap()
    };
    assert!((lamp(29) - DVec3::new(1.5, 2.6, 0.5)).length() < 1e-6);
    assert!((lamp(30) - DVec3::new(-1.5, 2.6, 0.5)).length() < 1e-6);
    assert!((lamp(60) - DVec3::new(-1.5, 2.2, 0.5)).length() < 1e-6);
    assert_eq!(paths[1].view(7).eye, scene.views[0].eye);
    // Under the sun the same path has a light that stands.
    assert!(paths[2].light_keys.is_empty());
    assert_eq!(paths[2].view.light.as_ref().unwrap().name, "sun");
}

fn channel(node: usize, path: &str, keys: [usize; 2], interpolation: &str) -> Value {
    let [input, output] = keys;
    json!({
        "channels": [{"sampler": 0, "target": {"node": node, "path": path}}],
        "samplers": [{"input": input, "output": output, "interpolation": interpolation}],
    })
}

/// Remarks on a document's animations, and the clips of it.
fn told(document: &Value) -> String {
    let (_, scene) = read(document);
    let names: Vec<&str> = scene.clips.iter().map(|clip| clip.name.as_str()).collect();
    format!("{}\ntaken: {}", scene.remarks.join("\n"), names.join(", "))
}

#[test]
fn animations_that_are_not_followed_are_told() {
    let named = |mut animation: Value, name: &str| {
        animation["name"] = name.into();
        animation
    };
    let nowhere = json!({"channels": [{"sampler": 0, "target": {"path": "pointer"}}]});
    let document = with(json!([
        named(channel(3, "translation", [6, 11], "CUBICSPLINE"), "smooth"),
        named(channel(1, "scale", [6, 10], "LINEAR"), "grow"),
        named(channel(3, "translation", [12, 7], "LINEAR"), "short"),
        channel(3, "translation", [6, 99], "LINEAR"),
        channel(3, "translation", [6, 8], "LINEAR"),
        channel(3, "translation", [7, 7], "LINEAR"),
        channel(3, "translation", [6, 7], "WAVY"),
        channel(1, "weights", [6, 7], "LINEAR"),
        channel(77, "translation", [6, 7], "LINEAR"),
        nowhere,
        {"channels": [{"sampler": 4, "target": {"node": 3, "path": "translation"}}]},
        channel(3, "rotation", [6, 8], "LINEAR"),
        named(channel(3, "translation", [6, 7], "LINEAR"), "walk"),
        named(channel(3, "translation", [6, 7], "STEP"), "Walk"),
    ]));
    assert_snapshot!(told(&document));
}

#[test]
fn nodes_of_one_name_and_rolling_cameras_are_told() {
    let mut document = with(json!([
        channel(1, "rotation", [6, 8], "LINEAR"),
        channel(3, "rotation", [6, 8], "LINEAR"),
    ]));
    document["nodes"][2]["name"] = "Door".into();
    // The turn about y is a roll of a camera that looks down, by what is above it.
    document["nodes"][3]["rotation"] = json!([-HALF, 0, 0, HALF]);
    document["nodes"][5] = json!({"name": "crane", "children": [3]});
    document["scenes"][0]["nodes"] = json!([0, 1, 4, 5]);
    document["animations"][1]["channels"][0]["target"]["node"] = 5.into();
    assert_snapshot!(told(&document));
}

#[test]
fn damaged_keys_leave_the_mesh_as_it_is() {
    let plain = read(&with(json!([]))).0;
    for (list, number, field, value) in [
        ("accessors", 7, "bufferView", json!(99)),
        ("accessors", 7, "count", json!(1u64 << 60)),
        ("accessors", 7, "componentType", json!(5125)),
        ("accessors", 7, "sparse", json!({})),
        ("accessors", 6, "type", json!("MAT4")),
        ("bufferViews", 7, "byteLength", json!(1u64 << 40)),
        ("bufferViews", 7, "byteOffset", json!(1u64 << 63)),
        ("bufferViews", 7, "byteStride", json!(1u64 << 62)),
        (
            "bufferViews",
            7,
            "extensions",
            json!({"EXT_meshopt_compression": {}}),
        ),
    ] {
        let mut document = with(json!([channel(3, "translation", [6, 7], "LINEAR")]));
        document[list][number][field] = value.clone();
        let (mesh, _) = read(&document);
        assert_eq!(mesh.triangles, plain.triangles, "{list} {field} {value}");
    }
}

/// Numbers that a damaged file may hold in the place of any value.
fn odd() -> impl Strategy<Value = Value> {
    prop_oneof![
        Just(Value::Null),
        Just(json!([])),
        Just(json!({})),
        Just(json!("x")),
        Just(json!(-1)),
        Just(json!(0)),
        Just(json!(1e308)),
        Just(json!(u64::MAX)),
        (0u32..12).prop_map(|number| json!(number)),
        proptest::num::f32::NORMAL.prop_map(|number| json!(number)),
    ]
}

/// The value at a place counted through all of a document but its buffers.
fn place<'v>(value: &'v mut Value, at: &mut usize) -> Option<&'v mut Value> {
    if *at == 0 {
        return Some(value);
    }
    *at -= 1;
    match value {
        Value::Array(items) => items.iter_mut().find_map(|item| place(item, at)),
        Value::Object(fields) => {
            let mut fields = fields.iter_mut().filter(|(name, _)| *name != "buffers");
            fields.find_map(|(_, item)| place(item, at))
        }
        _ => None,
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1000))]
    #[test]
    fn any_value_is_refused_told_or_harmless(at in 1usize..420, value in odd()) {
        let mut document = moving();
        let mut at = at;
        if let Some(there) = place(&mut document, &mut at) {
            *there = value;
        }
        let text = document.to_string();
        let read = parse_gltf_scene(text.as_bytes(), Path::new("moving.gltf"), Default::default());
        if let Ok((mesh, scene, _)) = read {
            for view in &scene.views {
                prop_assert!(view.check().is_ok());
            }
            for light in &scene.lights {
                prop_assert!(light.check().is_ok());
            }
            let standing = scene.views.first().cloned().unwrap_or_else(|| view(&mesh));
            for clip in &scene.clips {
                let paths = clip.paths(&scene.views, &scene.lights, &standing);
                for path in paths.into_iter().flatten() {
                    let movable = path.movable(&mesh).unwrap();
                    if let Some(movable) = movable {
                        let _ = path.shape(&movable, path.frames() - 1);
                    }
                }
            }
        }
    }
}

fn view(mesh: &Mesh) -> View {
    let (min, max) = mesh.bounds().unwrap();
    View {
        eye: max.as_dvec3(),
        direction: (min - max).as_dvec3(),
        far: 100.0,
        ..View::default()
    }
}
