//! Faults of files that once went by without a word, or that refused what is allowed: each is read,
//! or told by name (`tests/inputs/`).

use glam::{DQuat, DVec3, Vec3};
use serde_json::{Value, json};
use skiagraph_scene::{
    ImportReport, LightKind, MaterialUse, Mesh, ObjMaterials, ObjOptions, Pattern, SceneError,
    gltf::{GltfScene, parse_gltf_scene},
    load_obj,
    obj::parse_obj,
};
use std::{
    fs,
    path::{Path, PathBuf},
};

fn inputs() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/inputs")
}

fn document(file: &str) -> Value {
    let bytes = fs::read(inputs().join(file)).unwrap();
    serde_json::from_slice(&bytes).unwrap()
}

type Read = (Mesh, GltfScene, ImportReport);

fn read_with(document: &Value, materials: MaterialUse) -> Result<Read, SceneError> {
    let text = document.to_string();
    parse_gltf_scene(text.as_bytes(), &inputs().join("a.gltf"), materials)
}

fn read(document: &Value) -> Read {
    read_with(document, MaterialUse::All).unwrap()
}

/// The primitive ids of the plate of the masked documents.
fn plate(mesh: &Mesh) -> std::ops::Range<u32> {
    let mut groups = mesh.groups.iter();
    groups
        .find(|group| group.name == "plate")
        .unwrap()
        .triangles
        .clone()
}

/// A buffer view and an accessor of texture coordinates behind those that are there; its number.
fn add_uvs(document: &mut Value, uvs: [[f32; 2]; 4]) -> usize {
    use base64::{Engine, engine::general_purpose::STANDARD};
    let bytes: Vec<u8> = uvs.concat().iter().flat_map(|x| x.to_le_bytes()).collect();
    let uri = format!(
        "data:application/octet-stream;base64,{}",
        STANDARD.encode(bytes)
    );
    let push = |list: &mut Value, item: Value| {
        let list = list.as_array_mut().unwrap();
        list.push(item);
        list.len() - 1
    };
    let buffer = push(
        &mut document["buffers"],
        json!({"byteLength": 32, "uri": uri}),
    );
    let view = json!({"buffer": buffer, "byteLength": 32});
    let view = push(&mut document["bufferViews"], view);
    let accessor = json!({"bufferView": view, "componentType": 5126, "count": 4, "type": "VEC2"});
    push(&mut document["accessors"], accessor)
}

#[test]
fn a_mask_without_coordinates_is_told_and_opaque() {
    let bare = document("mask_without_coordinates.gltf");
    let texture = "/materials/0/pbrMetallicRoughness/baseColorTexture";
    let mut named = bare.clone();
    named["materials"][0]["name"] = json!("leaf");
    let good = [[0.0, 0.0], [0.0, 1.0], [1.0, 1.0], [1.0, 0.0]];
    let with = |uvs: [[f32; 2]; 4], set: &str| {
        let mut document = named.clone();
        let accessor = add_uvs(&mut document, uvs);
        document["meshes"][1]["primitives"][0]["attributes"][set] = json!(accessor);
        document
    };
    let mut second_set = with(good, "TEXCOORD_0");
    second_set.pointer_mut(texture).unwrap()["texCoord"] = json!(1);
    let mut transformed = with(good, "TEXCOORD_0");
    transformed.pointer_mut(texture).unwrap()["extensions"] =
        json!({"KHR_texture_transform": {"scale": [2, 2], "texCoord": 3}});
    let mut blended = named.clone();
    blended["materials"][0]["alphaMode"] = json!("BLEND");
    let odd = |value: f32| with([[value, 0.0], good[1], good[2], good[3]], "TEXCOORD_0");
    let mut short = with(good, "TEXCOORD_0");
    let last = short["accessors"].as_array().unwrap().len() - 1;
    short["accessors"][last]["count"] = json!(2);
    for (what, document, triangles) in [
        ("none", named.clone(), 2),
        ("no such set", with(good, "TEXCOORD_1"), 2),
        ("set 1 of 0", second_set, 2),
        ("set 3 by a transform", transformed, 2),
        ("NaN", odd(f32::NAN), 2),
        ("infinite", odd(f32::INFINITY), 2),
        ("too few", short, 2),
        ("blended", blended, 2),
    ] {
        let (mesh, _, report) = read_with(&document, MaterialUse::BlendMask).unwrap();
        let remarks: Vec<&String> = report.remarks.iter().collect();
        let [remark] = remarks[..] else {
            panic!("{what}: {:?}", report.remarks)
        };
        for part in [
            "\"leaf\"",
            "\"plate\"",
            &format!("{triangles} triangles"),
            "opaque",
        ] {
            assert!(remark.contains(part), "{what}: no {part} in {remark}");
        }
        assert!(
            plate(&mesh).all(|id| mesh.surfaces.mask(id).is_none()),
            "{what}"
        );
        assert!(
            plate(&mesh).all(|id| mesh.surfaces.is_double_sided(id)),
            "{what}"
        );
    }
    // One triangle alone lacks a corner's.
    let (mesh, _, report) = read(&with(
        [good[0], good[1], good[2], [f32::NAN; 2]],
        "TEXCOORD_0",
    ));
    let masked = plate(&mesh).filter(|id| mesh.surfaces.mask(*id).is_some());
    assert_eq!((masked.count(), report.remarks.len()), (1, 1), "{report}");
    assert!(report.remarks[0].contains("1 triangle without"), "{report}");
    // With them there is nothing to say, nor where nothing is looked up.
    let mut plain = named;
    plain["materials"][0]["pbrMetallicRoughness"] = json!({"baseColorFactor": [1, 1, 1, 0.2]});
    let mut opaque = bare;
    opaque["materials"][0]["alphaMode"] = json!("OPAQUE");
    for document in [document("mask_with_coordinates.gltf"), plain, opaque] {
        assert_eq!(read(&document).2.remarks, [""; 0]);
    }
}

/// A folder with an OBJ file of a masked plate, whose faces are `faces`.
fn plate_obj(faces: &str) -> (Mesh, ImportReport) {
    let obj = fs::read_to_string(inputs().join("boost.obj")).unwrap();
    let text = obj.replace("f 5/1 6/2 7/3 8/4", faces);
    assert_ne!(text, obj);
    parse_obj(
        text.as_bytes(),
        &inputs().join("plate.obj"),
        &ObjOptions::default(),
    )
    .unwrap()
}

#[test]
fn faces_without_coordinates_under_a_mask_are_told_and_opaque() {
    let odd = "vt nan 0\nf 5/5 6/2 7/3\nf 5/1 7/3 8/4";
    for (faces, masked) in [("f 5 6 7 8", 0), ("f 5/1 6/2 7 8", 0), (odd, 1)] {
        let (mesh, report) = plate_obj(faces);
        let remarks = report.remarks.join("\n");
        assert!(remarks.contains("material \"leaf\""), "{faces}: {remarks}");
        assert!(
            remarks.contains("the first in \"unnamed\": opaque there"),
            "{faces}: {remarks}"
        );
        let ids = 0..mesh.triangles.len() as u32;
        let count = ids.filter(|id| mesh.surfaces.mask(*id).is_some()).count();
        assert_eq!(count, masked, "{faces}");
    }
    // Masks that a scene file makes are looked up without an .mtl, too.
    let options = ObjOptions {
        materials: ObjMaterials::Made([("leaf".to_owned(), Pattern::Leaves)].into()),
        ..ObjOptions::default()
    };
    let text = "v 0 0 0\nv 1 0 0\nv 1 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nusemtl leaf\nf 1/1 2/2 3/3\n";
    let read = |text: &str| parse_obj(text.as_bytes(), Path::new("a.obj"), &options).unwrap();
    let (mesh, report) = read(text);
    assert!(!report.has_warnings(), "{report}");
    assert_eq!(mesh.surfaces.corner_uvs(0)[1], glam::Vec2::new(1.0, 1.0));
    let (mesh, report) = read(&text.replace("f 1/1 2/2 3/3", "f 1 2 3"));
    assert_eq!(report.remarks.len(), 1, "{report}");
    assert!(mesh.surfaces.mask(0).is_none());
}

/// The positions of the triangles, in their order.
fn corners(mesh: &Mesh) -> Vec<Vec3> {
    let indices = mesh.triangles.iter().flatten();
    indices
        .map(|index| mesh.positions[*index as usize])
        .collect()
}

fn assert_near(what: &str, left: &[Vec3], right: &[Vec3]) {
    assert_eq!(left.len(), right.len(), "{what}");
    for (a, b) in left.iter().zip(right) {
        assert!(a.distance(*b) < 1e-5, "{what}: {a} beside {b}");
    }
}

#[test]
fn rotations_of_any_length_turn_alike() {
    let unit = document("turn_unit.gltf");
    let expected = corners(&read(&unit).0);
    assert_near(
        "longer",
        &corners(&read(&document("turn_longer.gltf")).0),
        &expected,
    );
    let turn: Vec<f64> = serde_json::from_value(unit["nodes"][1]["rotation"].clone()).unwrap();
    let scaled = |by: f64| {
        json!(
            turn.iter()
                .map(|component| component * by)
                .collect::<Vec<f64>>()
        )
    };
    for by in [1e-12, 0.3, -1.0, 7.0, 1e9] {
        let mut document = unit.clone();
        document["nodes"][1]["rotation"] = scaled(by);
        let (mesh, _, report) = read(&document);
        assert_near(&format!("times {by}"), &corners(&mesh), &expected);
        assert_eq!(report.remarks, [""; 0]);
        // A parent of the mesh, with the mesh at rest below it.
        let mut above = unit.clone();
        above["nodes"][1] = json!({"name": "bar", "mesh": 1});
        above["nodes"].as_array_mut().unwrap().push(json!(
            {"name": "stand", "translation": [0, 1.5, 0], "rotation": scaled(by), "children": [1]}
        ));
        above["scenes"][0]["nodes"] = json!([0, 2]);
        assert_near(
            &format!("parent, times {by}"),
            &corners(&read(&above).0),
            &expected,
        );
    }
}

#[test]
fn cameras_and_lights_stand_as_their_nodes_do() {
    let document = document("spot_90.gltf");
    let (_, expected, _) = read(&document);
    for by in [1e-6, 3.0] {
        let mut longer = document.clone();
        for node in [2, 3] {
            for component in longer["nodes"][node]["rotation"].as_array_mut().unwrap() {
                *component = json!(component.as_f64().unwrap() * by);
            }
        }
        let (_, scene, _) = read(&longer);
        let [view, other] = [&scene.views[0], &expected.views[0]];
        assert!(
            (view.direction - other.direction).length() < 1e-6,
            "{view:?}"
        );
        assert!((view.up - other.up).length() < 1e-6, "{view:?}");
        let direction = |scene: &GltfScene| match scene.lights[0].kind {
            LightKind::Spot(spot) => spot.direction,
            other => panic!("{other:?}"),
        };
        assert!((direction(&scene) - direction(&expected)).length() < 1e-6);
    }
}

#[test]
fn a_rotation_that_turns_nothing_is_told_by_the_nodes_name() {
    let mut document = document("turn_unit.gltf");
    document["nodes"][1]["rotation"] = json!([0, 0, 0, 0]);
    let (mesh, _, report) = read(&document);
    assert_eq!(
        report.remarks,
        [
            "node 1 \"bar\": its rotation is 0, 0, 0, 0, which turns nothing: mend it if that is \
          not meant"
        ]
    );
    document["nodes"][1]
        .as_object_mut()
        .unwrap()
        .remove("rotation");
    assert_near("none", &corners(&mesh), &corners(&read(&document).0));
}

#[test]
fn keys_turn_from_a_rest_of_any_length() {
    use base64::{Engine, engine::general_purpose::STANDARD};
    // The bar rises; its turn at rest is not of length 1.
    let mut document = document("turn_longer.gltf");
    let numbers = [0f32, 1.0, 0.0, 1.5, 0.0, 0.0, 2.5, 0.0];
    let bytes: Vec<u8> = numbers.iter().flat_map(|x| x.to_le_bytes()).collect();
    let uri = format!(
        "data:application/octet-stream;base64,{}",
        STANDARD.encode(bytes)
    );
    for (list, items) in [
        ("buffers", json!([{"byteLength": 32, "uri": uri}])),
        (
            "bufferViews",
            json!([{"buffer": 1, "byteLength": 8},
                   {"buffer": 1, "byteOffset": 8, "byteLength": 24}]),
        ),
        (
            "accessors",
            json!([{"bufferView": 6, "componentType": 5126, "count": 2, "type": "SCALAR"},
                   {"bufferView": 7, "componentType": 5126, "count": 2, "type": "VEC3"}]),
        ),
    ] {
        let there = document[list].as_array_mut().unwrap();
        there.extend(items.as_array().unwrap().clone());
    }
    document["animations"] = json!([{
        "samplers": [{"input": 6, "output": 7}],
        "channels": [{"sampler": 0, "target": {"node": 1, "path": "translation"}}],
    }]);
    let (_, scene, _) = read(&document);
    assert_eq!(scene.remarks, [""; 0]);
    let view = skiagraph_scene::View {
        name: "v".into(),
        eye: DVec3::new(0.0, 2.0, 9.0),
        far: 50.0,
        ..skiagraph_scene::View::default()
    };
    let paths = scene.clips[0].paths(&scene.views, &scene.lights, &view);
    let path = paths.into_iter().next().unwrap().unwrap();
    let skiagraph_scene::Motion::Posed { keys, .. } = &path.moves[0] else {
        panic!("{:?}", path.moves)
    };
    // It does not turn: it stands as it did at rest.
    assert!(
        keys.iter()
            .all(|key| key.rotation.angle_between(DQuat::IDENTITY) < 1e-6)
    );
}

#[test]
fn a_spot_of_half_the_space_is_one_of_nearly_half() {
    let (_, scene, _) = read(&document("spot_90.gltf"));
    let [light] = &scene.lights[..] else {
        panic!("{:?}", scene.lights)
    };
    let LightKind::Spot(spot) = light.kind else {
        panic!("{light:?}")
    };
    assert_eq!((light.name.as_str(), spot.cone_degrees), ("spot", 179.9));
    let [remark] = &scene.remarks[..] else {
        panic!("{:?}", scene.remarks)
    };
    assert!(
        remark.starts_with("node 3 \"spot\": its cone of 180.00 degrees counts as"),
        "{remark}"
    );
    let cone = |angle: f64| {
        let mut document = document("spot_90.gltf");
        document["extensions"]["KHR_lights_punctual"]["lights"][0]["spot"] =
            json!({"outerConeAngle": angle, "innerConeAngle": angle});
        let (_, scene, _) = read(&document);
        let width = scene.lights.first().map(|light| match light.kind {
            LightKind::Spot(spot) => spot.cone_degrees,
            other => panic!("{other:?}"),
        });
        (width, scene.remarks)
    };
    // A right angle in f32 is a little more.
    assert_eq!(cone(1.5707964).0, Some(179.9));
    let (width, remarks) = cone(1.5);
    assert_eq!((width, remarks), (Some(3f64.to_degrees()), vec![]));
    for angle in [0.0, -1.0, 1.6] {
        let (width, remarks) = cone(angle);
        assert_eq!(width, None, "{angle}");
        assert!(remarks[0].contains("at most a right angle"), "{remarks:?}");
    }
}

#[test]
fn the_range_of_a_light_bears_on_nothing_and_is_told() {
    let with = |kind: &str, range: f64| {
        let mut document = document("spot_90.gltf");
        document["extensions"]["KHR_lights_punctual"]["lights"][0] =
            json!({"type": kind, "range": range});
        let (_, scene, _) = read(&document);
        (scene.lights.len(), scene.remarks)
    };
    for kind in ["spot", "point"] {
        let remark = "the range of 1 light bears on nothing: a shadow counts at any distance";
        assert_eq!(with(kind, 3.0), (1, vec![remark.to_owned()]), "{kind}");
    }
    // The extension has it ignored there.
    for range in [3.0, 0.0] {
        assert_eq!(with("directional", range), (1, vec![]));
    }
}

#[test]
fn blended_leaves_are_masks_where_that_is_asked_for() {
    let mut document = document("mask_with_coordinates.gltf");
    let (masked, ..) = read(&document);
    document["materials"][0]["alphaMode"] = json!("BLEND");
    // It is of masks alone, by the format.
    document["materials"][0]["alphaCutoff"] = json!(0.0);
    let (mesh, _, report) = read(&document);
    assert!(!plate(&mesh).any(|id| mesh.surfaces.mask(id).is_some()));
    let remarks = report.to_string();
    assert!(
        remarks.contains("--materials blend=mask") && remarks.contains("BlendMask"),
        "{remarks}"
    );
    let (mesh, _, report) = read_with(&document, MaterialUse::BlendMask).unwrap();
    assert_eq!(report.remarks, [""; 0]);
    for (id, other) in plate(&mesh).zip(plate(&masked)) {
        assert!(mesh.surfaces.mask(id).is_some());
        assert_eq!(mesh.surfaces.mask(id), masked.surfaces.mask(other));
    }
    let options: ObjOptions = ObjOptions {
        materials: MaterialUse::BlendMask.into(),
        ..ObjOptions::default()
    };
    assert_eq!(options.materials, ObjMaterials::All);
}

#[test]
fn every_option_of_the_specification_stands_before_a_mask() {
    let read = |options: &str, file: &str| {
        let folder = tempfile::tempdir().unwrap();
        let place = |name: &str| folder.path().join(name);
        fs::copy(inputs().join("a.png"), place(file)).unwrap();
        fs::copy(inputs().join("boost.obj"), place("boost.obj")).unwrap();
        let mtl = format!("newmtl leaf\nmap_d {options} {file}\n");
        fs::write(place("boost.mtl"), mtl).unwrap();
        load_obj(&place("boost.obj"), &ObjOptions::default())
    };
    let (mesh, _) = load_obj(&inputs().join("boost.obj"), &ObjOptions::default()).unwrap();
    assert!(mesh.surfaces.need_care());
    for options in [
        "-blendu off -blendv on -boost 2",
        "-cc on -clamp off -texres 256",
        "-colorspace linear",
        "-turb 0.1 0.2 0.3",
        "-bm 1 -type sphere -imfchan m",
    ] {
        for file in ["a.png", "a leaf.png"] {
            let (mesh, _) = read(options, file).unwrap_or_else(|why| panic!("{options}: {why}"));
            assert!(mesh.surfaces.need_care(), "{options} {file}");
        }
    }
}

#[test]
fn an_outline_that_goes_out_and_back_is_cut() {
    let options = ObjOptions::default();
    let (mesh, report) = load_obj(&inputs().join("spike.obj"), &options).unwrap();
    assert!(!report.has_warnings(), "{report}");
    let area = |mesh: &Mesh| -> f64 {
        let corner = |index: u32| mesh.positions[index as usize].as_dvec3();
        let cross = mesh.triangles.iter().map(|triangle| {
            let [a, b, c] = triangle.map(corner);
            (b - a).cross(c - a)
        });
        cross.sum::<DVec3>().length() / 2.0
    };
    // The floor of 8 by 8 and the square of 2 by 2, both wound alike.
    assert!((area(&mesh) - 68.0).abs() < 1e-9, "{}", area(&mesh));
    // Spikes at every corner and side, outwards and inwards, straight and slanted, out by two steps
    // and back by one, from the outline of an L too.
    let square = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
    let l = [
        [0.0, 0.0],
        [2.0, 0.0],
        [2.0, 1.0],
        [1.0, 1.0],
        [1.0, 2.0],
        [0.0, 2.0],
    ];
    let spikes: [&[[f64; 2]]; 5] = [
        &[[3.0, 0.0]],
        &[[0.3, 0.2]],
        &[[0.7, 1.9]],
        &[[-0.1, -0.3]],
        &[[2.0, 1.0], [4.0, 2.0], [3.0, 1.5]],
    ];
    for (outline, whole) in [(&square[..], 4.0), (&l[..], 3.0)] {
        for at in 0..outline.len() {
            for spike in spikes {
                let mut corners = outline.to_vec();
                let foot = corners[at];
                let tips = spike.iter().map(|by| [foot[0] + by[0], foot[1] + by[1]]);
                let tips: Vec<[f64; 2]> = tips.collect();
                corners.splice(at + 1..at + 1, tips.iter().copied().chain([foot]));
                let mut text = String::new();
                for [x, y] in &corners {
                    text += &format!("v {x} {y} 3\n");
                }
                let numbers: Vec<String> = (1..=corners.len()).map(|n| n.to_string()).collect();
                text += &format!("f {}\n", numbers.join(" "));
                let read = parse_obj(text.as_bytes(), Path::new("a.obj"), &options);
                let (mesh, _) = read.unwrap_or_else(|why| panic!("{corners:?}: {why}"));
                let own = area(&mesh);
                assert!((own - whole).abs() < 1e-5, "{own} of {corners:?}");
            }
        }
    }
}

#[test]
fn a_scene_without_nodes_is_told() {
    let mut document = document("turn_unit.gltf");
    for scenes in [
        json!([{}]),
        json!([{"name": "empty"}]),
        json!([{"nodes": []}]),
    ] {
        document["scenes"] = scenes;
        let why = read_with(&document, MaterialUse::All)
            .unwrap_err()
            .to_string();
        assert!(why.contains("a.gltf: scene 0: it has no nodes"), "{why}");
    }
    // Another one may be empty.
    document["scenes"] = json!([{}, {"nodes": [0, 1]}]);
    document["scene"] = json!(1);
    assert_eq!(read(&document).0.triangles.len(), 14);
}

/// Names in Windows-1252, as older exporters write them, in text and on disk.
#[cfg(unix)]
#[test]
fn names_that_are_not_utf_8_are_read() {
    use std::{ffi::OsStr, os::unix::ffi::OsStrExt};
    let latin = OsStr::from_bytes(b"bl\xe4tter.png");
    for on_disk in [latin, OsStr::new("blätter.png")] {
        for in_text in [&b"bl\xe4tter.png"[..], "blätter.png".as_bytes()] {
            let folder = tempfile::tempdir().unwrap();
            let place = |name: &str| folder.path().join(name);
            fs::copy(inputs().join("a.png"), folder.path().join(on_disk)).unwrap();
            fs::copy(inputs().join("boost.obj"), place("boost.obj")).unwrap();
            let mtl = [&b"newmtl leaf\nmap_d "[..], in_text, b"\n"].concat();
            fs::write(place("boost.mtl"), mtl).unwrap();
            let (mesh, report) = load_obj(&place("boost.obj"), &ObjOptions::default()).unwrap();
            assert!(
                mesh.surfaces.need_care() && !report.has_warnings(),
                "{report}"
            );
            let mut document = document("mask_with_coordinates.gltf");
            document["images"][0] = json!({"uri": "URI"});
            let text = document.to_string();
            for uri in [in_text.to_vec(), percent(in_text)] {
                let (before, behind) = text.split_once("URI").unwrap();
                let bytes = [before.as_bytes(), &uri, behind.as_bytes()].concat();
                let path = place("a.gltf");
                let (mesh, _, report) = parse_gltf_scene(&bytes, &path, MaterialUse::All).unwrap();
                assert!(
                    mesh.surfaces.need_care() && !report.has_warnings(),
                    "{report}"
                );
            }
        }
    }
}

/// As a URI writes bytes that are not ASCII.
#[cfg(unix)]
fn percent(bytes: &[u8]) -> Vec<u8> {
    let escaped = |byte: &u8| match byte {
        0x80.. => format!("%{byte:02X}").into_bytes(),
        _ => vec![*byte],
    };
    bytes.iter().flat_map(escaped).collect()
}

#[test]
fn a_tuple_in_the_place_of_fields_is_told() {
    let text = "(format: 1, name: \"a\", mesh: Generated(\"park\"), \
                light: (direction: (0, -1, 0)),\n \
                views: [(name: \"a\", eye: (0, 9, 0), direction: (0, -1, 0.1), fov_y_degrees: 60, \
                near: 1, far: 9)],\n paths: [(name: \"p\", fov_y_degrees: 60, near: 1, far: 9, \
                keys: [(0, (0, 1, 2), (0, 0, -1))])])";
    let why = skiagraph_scene::SceneFile::parse(text, "a.ron").unwrap_err();
    let SceneError::SceneFile(diagnostics) = why else {
        panic!("{why}")
    };
    let message = diagnostics.to_string();
    assert!(
        message.contains("what has fields, `(name: …)`, is needed"),
        "{message}"
    );
    assert!(!message.contains("r#"), "{message}");
}
