//! Cameras and lights of glTF files: which become views and lights, and what is said of the others.

use glam::DVec3;
use insta::assert_snapshot;
use skiagraph_scene::{
    LightKind, MaterialUse, SceneLibrary,
    gltf::{GltfScene, parse_gltf_scene},
};
use std::{fs, path::Path};

/// A square of 4 units on the ground, as node 0, with what else a test says.
fn document(nodes: &str, cameras: &str, lights: &str) -> String {
    // One node in a line, behind a comma.
    let count = nodes.lines().filter(|line| line.contains('{')).count();
    let children: Vec<String> = (0..=count).map(|node| node.to_string()).collect();
    let children = children.join(", ");
    format!(
        r#"{{
  "asset": {{"version": "2.0"}},
  "extensionsUsed": ["KHR_lights_punctual"],
  "extensionsRequired": ["KHR_lights_punctual"],
  "scene": 0,
  "scenes": [{{"nodes": [{children}]}}],
  "nodes": [{{"name": "floor", "mesh": 0}}{nodes}],
  "cameras": [{cameras}],
  "extensions": {{"KHR_lights_punctual": {{"lights": [{lights}]}}}},
  "meshes": [{{"primitives": [{{"attributes": {{"POSITION": 0}}, "indices": 1}}]}}],
  "accessors": [
    {{"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3",
      "min": [-2, 0, -2], "max": [2, 0, 2]}},
    {{"bufferView": 1, "componentType": 5123, "count": 6, "type": "SCALAR"}}
  ],
  "bufferViews": [
    {{"buffer": 0, "byteLength": 48}},
    {{"buffer": 0, "byteOffset": 48, "byteLength": 12}}
  ],
  "buffers": [{{"byteLength": 60, "uri": "data:application/octet-stream;base64,{FLOOR}"}}]
}}"#
    )
}

/// (−2, 0, −2), (−2, 0, 2), (2, 0, 2), (2, 0, −2); 0 1 2 0 2 3.
const FLOOR: &str =
    "AAAAwAAAAAAAAADAAAAAwAAAAAAAAABAAAAAQAAAAAAAAABAAAAAQAAAAAAAAADAAAABAAIAAAACAAMA";

fn scene(nodes: &str, cameras: &str, lights: &str) -> GltfScene {
    let text = document(nodes, cameras, lights);
    let read = parse_gltf_scene(
        text.as_bytes(),
        Path::new("room.gltf"),
        MaterialUse::default(),
    );
    let (mesh, scene, report) = read.unwrap();
    assert_eq!(mesh.triangles.len(), 2);
    assert_eq!(report.remarks, [""; 0]);
    scene
}

/// Turned by 90 degrees about x, so that −z points down.
const DOWN: &str = r#""rotation": [-0.70710678, 0, 0, 0.70710678]"#;

const PERSPECTIVE: &str =
    r#"{"type": "perspective", "perspective": {"yfov": 0.8, "znear": 0.1, "zfar": 50}}"#;

#[test]
fn cameras_are_views_and_lights_are_lights_where_their_nodes_are() {
    let lamp = r#""extensions": {"KHR_lights_punctual": {"light": 1}}"#;
    let nodes = format!(
        r#",
        {{"name": "Cam.001", "translation": [1, 2, 3], "camera": 0}},
        {{"translation": [0, 5, 0], {DOWN}, "camera": 1, "scale": [3, 3, 3]}},
        {{"name": "Sun", {DOWN}, "extensions": {{"KHR_lights_punctual": {{"light": 0}}}}}},
        {{"name": "Lamp", "translation": [0, 4, 1], {DOWN}, {lamp}}},
        {{"translation": [1, 1, 1], "extensions": {{"KHR_lights_punctual": {{"light": 2}}}}}}"#
    );
    let cameras = format!(r#"{PERSPECTIVE}, {}"#, PERSPECTIVE.replace("0.8", "1.6"));
    let lights = r#"{"type": "directional", "intensity": 3},
        {"type": "spot", "spot": {"outerConeAngle": 0.5}},
        {"type": "point", "name": "Bulb", "color": [1, 0.5, 0]}"#;
    let scene = scene(&nodes, &cameras, lights);
    assert_eq!(scene.remarks, [""; 0]);
    let [first, second] = &scene.views[..] else {
        panic!("{:?}", scene.views)
    };
    assert_eq!(
        (first.name.as_str(), first.eye),
        ("cam_001", DVec3::new(1., 2., 3.))
    );
    assert_eq!((first.direction, first.up), (DVec3::NEG_Z, DVec3::Y));
    assert_eq!((first.near, first.far), (0.1, 50.0));
    assert!((first.fov_y_degrees - 0.8f64.to_degrees()).abs() < 1e-12);
    assert_eq!(second.name, "camera_2");
    assert!((second.direction - DVec3::NEG_Y).length() < 1e-6);
    assert!((second.up - DVec3::NEG_Z).length() < 1e-6);
    let names: Vec<&str> = scene
        .lights
        .iter()
        .map(|light| light.name.as_str())
        .collect();
    assert_eq!(names, ["sun", "lamp", "bulb"]);
    let sun = scene.lights[0].kind.directional().unwrap();
    assert!((sun.direction - DVec3::NEG_Y).length() < 1e-6);
    let LightKind::Spot(spot) = scene.lights[1].kind else {
        panic!("{:?}", scene.lights)
    };
    assert_eq!(spot.position, DVec3::new(0., 4., 1.));
    assert!((spot.cone_degrees - 1f64.to_degrees()).abs() < 1e-9);
    assert_eq!(scene.lights[2].kind.position(), Some(DVec3::ONE));
}

/// Remarks on a file, and the names of its views and lights.
fn told(nodes: &str, cameras: &str, lights: &str) -> String {
    let scene = scene(nodes, cameras, lights);
    let views = scene.views.iter().map(|view| view.name.as_str());
    let lights = scene.lights.iter().map(|light| light.name.as_str());
    let names: Vec<&str> = views.chain(lights).collect();
    format!("{}\ntaken: {}", scene.remarks.join("\n"), names.join(", "))
}

#[test]
fn cameras_that_are_no_views_are_told() {
    let nodes = r#",
        {"name": "top", "camera": 0},
        {"name": "far", "camera": 1, "translation": [0, 0, 10]},
        {"name": "far", "camera": 2, "scale": [-1, 1, 1]},
        {"name": "flat", "camera": 3},
        {"camera": 9},
        {"camera": "one"},
        {"name": "fish", "camera": 5},
        {"name": "no lens", "camera": 6},
        {"name": "squashed", "camera": 2, "scale": [1, 1, 0]}"#;
    let flat = r#"{"xmag": 1, "ymag": 1, "znear": 0, "zfar": 9}"#;
    let cameras = format!(
        r#"{{"type": "orthographic", "orthographic": {flat}}},
        {{"type": "perspective", "perspective": {{"yfov": 0.8, "znear": 0.1}}}},
        {PERSPECTIVE},
        {{"type": "perspective", "perspective": {{"yfov": 0.8, "znear": 0, "zfar": 50}}}},
        {{"name": "spare", "type": "perspective", "perspective": {{"yfov": 1, "znear": 1}}}},
        {{"type": "fisheye"}},
        {{"type": "perspective"}}"#
    );
    assert_snapshot!(told(nodes, &cameras, ""));
}

#[test]
fn lights_that_light_nothing_are_told() {
    let light =
        |number: u32| format!(r#""extensions": {{"KHR_lights_punctual": {{"light": {number}}}}}"#);
    let mut nodes = String::new();
    for (name, number) in [
        ("off", 0),
        ("short", 1),
        ("black", 2),
        ("lamp", 3),
        ("Lamp", 3),
        ("wide", 4),
        ("area", 5),
        ("missing", 12),
    ] {
        nodes += &format!(",\n{{\"name\": \"{name}\", {}}}", light(number));
    }
    nodes += ",\n{\"name\": \"hidden\", \"extensions\": {\"KHR_lights_punctual\": {\"light\": 3}, \
              \"KHR_node_visibility\": {\"visible\": false}}}";
    nodes += &format!(
        ",\n{{\"name\": \"flat\", \"scale\": [1, 1, 0], {}}}",
        light(6)
    );
    let lights = r#"{"type": "point", "intensity": 0},
        {"type": "point", "range": 0},
        {"type": "directional", "color": [0, 0, 0]},
        {"type": "point", "range": 20},
        {"type": "spot", "spot": {"outerConeAngle": 1.5707964}},
        {"type": "area"},
        {"type": "directional"},
        {"type": "point", "name": "spare"}"#;
    assert_snapshot!(told(&nodes, "", lights));
}

#[test]
fn a_file_with_a_camera_and_a_light_is_a_scene() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("room.gltf");
    let load = || SceneLibrary::default().load(path.to_str().unwrap());
    let nodes = r#",
        {"name": "Camera", "camera": 0},
        {"name": "Lamp", "extensions": {"KHR_lights_punctual": {"light": 0}}}"#;
    let lights = r#"{"type": "point"}"#;
    fs::write(&path, document(nodes, PERSPECTIVE, lights)).unwrap();
    let (scene, _) = load().unwrap();
    assert_eq!((scene.name.as_str(), scene.views.len()), ("room", 1));
    assert_eq!(scene.light().position(), Some(DVec3::ZERO));
    fs::write(&path, document("", "", lights)).unwrap();
    let error = load().unwrap_err().to_string();
    assert!(
        error.contains("it holds no camera or no light: give --eye"),
        "{error}"
    );
}
