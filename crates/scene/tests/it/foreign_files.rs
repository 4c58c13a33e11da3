//! Files of other programs (`tests/faults/`): each loads as its control does, or says what cannot
//! be read and the way out.

use base64::{Engine, engine::general_purpose::STANDARD};
use glam::{DVec3, Vec3};
use skiagraph_scene::{
    Concave, ImportReport, MaterialUse, Mesh, ObjMaterials, ObjOptions, SceneError,
    gltf::parse_gltf, load_gltf, load_obj,
};
use std::{
    collections::BTreeSet,
    path::{Path, PathBuf},
};

/// Fate of a file.
enum Becomes {
    /// The floor and so many plates of twelve triangles at their places; a remark holds the words,
    /// or there is none.
    Plates(&'static [f32], &'static str),
    /// No floor beside the plate, else as `Plates`.
    Refused(&'static [&'static str]),
}
use Becomes::{Plates, Refused};

const ONE: &[f32] = &[0.0];

/// Every file of `tests/faults/` that is not named by another one.
const FILES: [(&str, Becomes); 33] = [
    (
        "bare-obj-way-out/bow_tie.obj",
        Refused(&["line 20", "crosses itself", "--concave fan"]),
    ),
    (
        "bare-obj-way-out/list.obj",
        Plates(ONE, "not_there.mtl passed over"),
    ),
    (
        "bare-obj-way-out/missing_mtl.obj",
        Refused(&["not_there.mtl", "--materials ignore"]),
    ),
    ("bounds-missing/no_minmax.gltf", Plates(ONE, "")),
    (
        "draco-unnamed/basisu.gltf",
        Refused(&["KHR_texture_basisu", "PNG", "--materials color"]),
    ),
    (
        "draco-unnamed/draco.gltf",
        Refused(&["KHR_draco_mesh_compression", "export it without"]),
    ),
    ("gltf1-and-bom/bom.gltf", Plates(ONE, "")),
    (
        "gltf1-and-bom/cut.glb",
        Refused(&["cut off", "999999 bytes"]),
    ),
    (
        "gltf1-and-bom/v1.gltf",
        Refused(&["glTF 1.0", "2.0", "convert it"]),
    ),
    ("instances/instancing.gltf", Plates(&[-2.5, 0.0, 2.5], "")),
    (
        "mask-vertex-alpha/g2_mask_vertex_alpha.gltf",
        Plates(ONE, ""),
    ),
    ("mtl-one-number/plate.obj", Plates(ONE, "")),
    ("mtl-strict/halo.obj", Plates(ONE, "`d -halo 0.9`")),
    ("mtl-strict/illum.obj", Plates(ONE, "")),
    ("mtl-strict/infinite.obj", Plates(ONE, "")),
    ("mtl-strict/latin1.obj", Plates(ONE, "")),
    ("mtl-strict/nameless.obj", Plates(ONE, "")),
    ("mtl-strict/no_value.obj", Plates(ONE, "")),
    ("mtl-strict/spectral.obj", Plates(ONE, "")),
    (
        "mtl-strict/xyz.obj",
        Plates(ONE, "`Kd xyz 0.3 0.2 0.1` passed over"),
    ),
    ("obj-not-utf8/latin1_comment.obj", Plates(ONE, "")),
    ("obj-not-utf8/latin1_group.obj", Plates(ONE, "")),
    ("obj-not-utf8/sjis.obj", Plates(ONE, "")),
    ("obj-not-utf8/utf16.obj", Plates(ONE, "")),
    ("obj-order-and-normals/faces_first.obj", Plates(ONE, "")),
    (
        "obj-order-and-normals/normals_absent.obj",
        Plates(ONE, "6 faces name normals"),
    ),
    ("quantized-positions/control.gltf", Plates(ONE, "")),
    ("quantized-positions/quant_required.gltf", Plates(ONE, "")),
    (
        "required-looks/clearcoat.gltf",
        Plates(ONE, "passed over: KHR_materials_clearcoat"),
    ),
    (
        "required-looks/variants.gltf",
        Plates(ONE, "passed over: KHR_materials_variants"),
    ),
    (
        "required-looks/webp.gltf",
        Plates(ONE, "passed over: EXT_texture_webp"),
    ),
    ("skin-pose/centimetres.gltf", Plates(ONE, "")),
    ("skin-pose/moved_node.gltf", Plates(ONE, "")),
];

fn faults() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/faults")
}

fn load(file: &str) -> Result<(Mesh, ImportReport), SceneError> {
    load_with(file, MaterialUse::All, Concave::Cut)
}

fn load_with(
    file: &str,
    materials: MaterialUse,
    concave: Concave,
) -> Result<(Mesh, ImportReport), SceneError> {
    let path = faults().join(file);
    if file.ends_with(".obj") {
        let options = ObjOptions {
            materials: ObjMaterials::from(materials),
            concave,
            ..ObjOptions::default()
        };
        load_obj(&path, &options)
    } else {
        load_gltf(&path, materials)
    }
}

/// The floor of 8 × 8 and the plates of 2 × 0.2 × 2 above it. Their corners are rounded: a file may
/// quantize them.
#[track_caller]
fn assert_plates(file: &str, mesh: &Mesh, places: &[f32]) {
    assert_eq!(mesh.triangles.len(), 2 + 12 * places.len(), "{file}");
    let rounded = |p: Vec3| (p * 100.0).round().as_ivec3().to_array();
    let corners: BTreeSet<[i32; 3]> = mesh.used_positions().map(rounded).collect();
    let mut expected = BTreeSet::new();
    for (x, z) in [(-1.0, -1.0), (-1.0, 1.0), (1.0, -1.0), (1.0, 1.0)] {
        expected.insert(rounded(Vec3::new(4.0 * x, 0.0, 4.0 * z)));
        for place in places {
            for y in [1.0, 1.2] {
                expected.insert(rounded(Vec3::new(x + place, y, z)));
            }
        }
    }
    assert_eq!(corners, expected, "{file}");
    // The floor's front is up, each plate is closed.
    let up = |primitive: u32| {
        let [a, b, c] = mesh.corners(primitive);
        (b - a).cross(c - a).y > 0.0
    };
    let floor = (0..mesh.triangles.len() as u32)
        .filter(|&triangle| mesh.corners(triangle).iter().all(|corner| corner.y == 0.0));
    assert!(floor.into_iter().all(up), "{file}");
    let parts = skiagraph_scene::Parts::new(mesh);
    let closed = parts.open.iter().filter(|open| !**open).count();
    assert_eq!(closed, places.len(), "{file}");
}

#[test]
fn each_loads_or_says_why_not() {
    for (file, becomes) in &FILES {
        match becomes {
            Plates(places, remark) => {
                let (mesh, report) = load(file).unwrap_or_else(|why| panic!("{file}: {why}"));
                assert_plates(file, &mesh, places);
                let remarks = report.to_string();
                assert_eq!(remarks.is_empty(), remark.is_empty(), "{file}: {remarks}");
                assert!(remarks.contains(remark), "{file}: {remarks}");
            }
            Refused(words) => {
                let error = load(file).expect_err(file).to_string();
                let has_words = words.iter().all(|word| error.contains(word));
                assert!(has_words && error.contains(file), "{error}");
            }
        }
    }
}

/// A file that is in no table is tested by nothing.
#[test]
fn every_file_is_in_the_table() {
    let mut files = Vec::new();
    for folder in std::fs::read_dir(faults()).unwrap() {
        let folder = folder.unwrap();
        for file in std::fs::read_dir(folder.path()).unwrap() {
            let name = file.unwrap().file_name().into_string().unwrap();
            if !name.ends_with(".mtl") {
                files.push(format!("{}/{name}", folder.file_name().to_str().unwrap()));
            }
        }
    }
    files.sort();
    assert_eq!(files, FILES.map(|(file, _)| file));
}

#[test]
fn what_was_refused_loads_as_its_message_says() {
    for (file, materials, concave, triangles) in [
        (
            "bare-obj-way-out/bow_tie.obj",
            MaterialUse::All,
            Concave::Fan,
            16,
        ),
        (
            "bare-obj-way-out/missing_mtl.obj",
            MaterialUse::Ignore,
            Concave::Cut,
            14,
        ),
        (
            "bare-obj-way-out/missing_mtl.obj",
            MaterialUse::Color,
            Concave::Cut,
            14,
        ),
        (
            "draco-unnamed/basisu.gltf",
            MaterialUse::Ignore,
            Concave::Cut,
            14,
        ),
        (
            "draco-unnamed/basisu.gltf",
            MaterialUse::Color,
            Concave::Cut,
            14,
        ),
    ] {
        let (mesh, report) = load_with(file, materials, concave).unwrap();
        assert_eq!(mesh.triangles.len(), triangles, "{file}");
        let is_told = report.to_string().contains("without colours");
        assert_eq!(is_told, materials == MaterialUse::Color, "{file}");
    }
}

#[test]
fn a_plate_whose_vertices_are_clear_is_hidden_under_a_mask() {
    let (mesh, _) = load("mask-vertex-alpha/g2_mask_vertex_alpha.gltf").unwrap();
    let hidden = (0..mesh.triangles.len() as u32).filter(|&primitive| {
        let uv = mesh.surfaces.corner_uvs(primitive)[0].as_dvec2();
        let mask = mesh.surfaces.mask(primitive);
        mask.is_some_and(|mask| !mask.ask(uv, glam::DVec2::ZERO).opaque)
    });
    assert_eq!(hidden.count(), 12);
}

const CONTROL: &str = include_str!("../faults/quantized-positions/control.gltf");

/// The control without spaces, something in it replaced.
#[track_caller]
fn control(from: &str, to: &str) -> Result<(Mesh, ImportReport), SceneError> {
    let text: String = CONTROL.split_whitespace().collect();
    assert!(text.contains(from), "{from}");
    let text = text.replacen(from, to, 1);
    parse_gltf(text.as_bytes(), Path::new("plate.gltf"), MaterialUse::All)
}

const PLATE: &str = r#"{"mesh":1}"#;

/// Asserts that the control, changed, is what it was, and that a remark holds the words, or that
/// there is none.
#[track_caller]
fn assert_harmless(from: &str, to: &str, remark: &str) {
    let (mesh, report) = control(from, to).unwrap_or_else(|why| panic!("{to}: {why}"));
    assert_plates(to, &mesh, ONE);
    let remarks = report.to_string();
    let is_told = remarks.contains(remark) && remarks.is_empty() == remark.is_empty();
    assert!(is_told, "{to}: {remarks}");
}

#[test]
fn what_moves_no_triangle_refuses_no_file() {
    let required = |names: &str| format!(r#""extensionsRequired":[{names}],"asset""#);
    for (from, to, remark) in [
        (
            r#""asset""#,
            required(r#""KHR_materials_sheen","KHR_texture_basisu""#),
            "KHR_texture_basisu",
        ),
        (
            r#""asset""#,
            required(r#""KHR_animation_pointer""#),
            "KHR_animation_pointer",
        ),
        (r#""asset""#, required(r#""KHR_node_visibility""#), ""),
        (
            r#""asset""#,
            required(r#""KHR_draco_mesh_compression""#),
            "",
        ),
        // One that is not known has its data where looks are.
        (
            r#""asset""#,
            format!(
                r#""materials":[{{"extensions":{{"ACME_paint":{{}}}}}}],{}"#,
                required(r#""ACME_paint""#)
            ),
            "ACME_paint",
        ),
        // The application's own attributes, with and without the underscore; one of no accessor.
        (
            r#""POSITION":2"#,
            r#""POSITION":2,"_WEAR":2,"TANGENT":99,"COLOR_1":99"#.into(),
            "",
        ),
        (
            r#""POSITION":2"#,
            r#""POSITION":2,"WEAR":2,"TEXCOORD":2"#.into(),
            "attribute WEAR",
        ),
    ] {
        assert_harmless(from, &to, remark);
    }
}

#[test]
fn looks_and_what_is_not_used_refuse_no_file() {
    for (from, to, remark) in [
        // Unused accessors, pictures and animations of any kind.
        (
            r#""accessors":["#,
            r#""animations":[{"channels":7}],"cameras":{},"accessors":["#,
            "",
        ),
        (
            r#""asset""#,
            r#""images":[{},{"bufferView":77}],"textures":[{}],"asset""#,
            "",
        ),
        (
            r#""byteLength":228,"uri""#,
            r#""byteLength":228,"extras":0,"uri""#,
            "",
        ),
        (r#""byteLength":96}"#, r#""byteLength":96,"target":1}"#, ""),
        (r#""version":"2.0""#, r#""version":2.0,"generator":7"#, ""),
        (
            r#""asset""#,
            r#""materials":[{"alphaMode":"BLEND"}],"asset""#,
            "of alphaMode BLEND",
        ),
        // Looks of a material.
        (
            r#""asset""#,
            r#""materials":[{"emissiveFactor":"red","normalTexture":{},"alphaMode":"GLASS"}],
                "samplers":[{"wrapS":33069,"magFilter":1}],"asset""#,
            "alphaMode \"GLASS\"",
        ),
    ] {
        assert_harmless(from, to, remark);
    }
}

#[test]
fn packed_and_old_files_say_so() {
    for (from, to, message) in [
        (
            r#""version":"2.0""#,
            r#""version":"1.1""#,
            "it is glTF 1.1, this program reads 2.0",
        ),
        (r#""version":"2.0""#, r#""version":"3.0""#, "it is glTF 3.0"),
        (
            r#""version":"2.0""#,
            r#""version":"2.1","minVersion":"2.1""#,
            "it is glTF 2.1",
        ),
        (
            r#""byteLength":96}"#,
            r#""byteLength":96,"extensions":{"EXT_meshopt_compression":{"buffer":0}}}"#,
            "",
        ),
        (
            r#""asset""#,
            r#""extensionsRequired":["ACME_paint"],"extensions":{"ACME_paint":{}},"asset""#,
            "export it without",
        ),
    ] {
        match control(from, to) {
            Ok((mesh, _)) => {
                assert_eq!(message, "", "{to}");
                assert_plates(to, &mesh, ONE);
            }
            Err(error) => {
                let error = error.to_string();
                assert!(
                    !message.is_empty() && error.contains(message),
                    "{to}: {error}"
                );
            }
        }
    }
    // The packed view stands in a buffer of its own, which nothing fills.
    let text: String = CONTROL.split_whitespace().collect();
    let packed = text
        .replace(
            r#""buffer":0,"byteOffset":60,"byteLength":96}"#,
            r#""buffer":1,"byteLength":96,"extensions":{"EXT_meshopt_compression":{"buffer":0}}}"#,
        )
        .replace(r#"AHAAMA"}]}"#, r#"AHAAMA"},{"byteLength":96}]}"#);
    let packed = parse_gltf(packed.as_bytes(), Path::new("a.gltf"), MaterialUse::All);
    let error = packed.unwrap_err().to_string();
    let message = "buffer view 2: it is compressed (EXT_meshopt_compression)";
    assert!(error.contains(message), "{error}");
    let text = CONTROL.trim_end();
    let cut = parse_gltf(
        &text.as_bytes()[..text.len() - 1],
        Path::new("plate.gltf"),
        MaterialUse::All,
    );
    let error = cut.unwrap_err().to_string();
    assert!(error.ends_with("the file is cut off"), "{error}");
}

#[test]
fn hidden_nodes_are_hidden_with_all_below_them() {
    let hidden = r#""extensions":{"KHR_node_visibility":{"visible":false}}"#;
    let (mesh, _) = control(PLATE, &format!(r#"{{"mesh":1,{hidden}}}"#)).unwrap();
    assert_plates("hidden", &mesh, &[]);
    let (mesh, _) = control(
        PLATE,
        &format!(r#"{{"children":[2],{hidden}}},{{"mesh":1}}"#),
    )
    .unwrap();
    assert_plates("hidden above", &mesh, &[]);
    let shown = hidden.replace("false", "true");
    let (mesh, _) = control(PLATE, &format!(r#"{{"mesh":1,{shown}}}"#)).unwrap();
    assert_plates("shown", &mesh, ONE);
}

#[test]
fn weights_of_morph_targets_are_followed() {
    // The target moves each vertex by its own position.
    let text: String = CONTROL.split_whitespace().collect();
    let target = r#""indices":3,"targets":[{"POSITION":2},{"POSITION":2}]}]"#;
    let text = text.replace(r#""indices":3}]"#, target);
    let height = |node: &str, mesh: &str| {
        let text = text
            .replace(PLATE, node)
            .replace(target, &format!("{target}{mesh}"));
        let parsed = parse_gltf(text.as_bytes(), Path::new("a.gltf"), MaterialUse::All);
        parsed.unwrap().0.bounds().unwrap().1.y
    };
    assert_eq!(height(PLATE, ""), 1.2);
    assert_eq!(height(PLATE, r#","weights":[1,0]"#), 2.4);
    // A node's weights count before its mesh's.
    assert_eq!(
        height(r#"{"mesh":1,"weights":[1,1]}"#, r#","weights":[1,0]"#),
        3.6000001
    );
    let short = text.replace(r#"[{"POSITION":2}"#, r#"[{"POSITION":0}"#);
    let short = short.replace(PLATE, r#"{"mesh":1,"weights":[1,0]}"#);
    let error = parse_gltf(short.as_bytes(), Path::new("a.gltf"), MaterialUse::All).unwrap_err();
    assert!(
        error
            .to_string()
            .contains("a morph target of 4 vertices for 8"),
        "{error}"
    );
}

#[test]
fn instances_are_turned_scaled_and_mirrored() {
    // Instances at the four corners of the floor: places, and scales that mirror.
    let instances = |attributes: &str| {
        let extension = format!(
            r#"{{"mesh":1,"scale":[0.5,0.5,0.5],
                "extensions":{{"EXT_mesh_gpu_instancing":{{"attributes":{{{attributes}}}}}}}}}"#
        );
        control(PLATE, &extension)
    };
    let (mesh, report) = instances(r#""TRANSLATION":0"#).unwrap();
    assert_eq!(
        (mesh.triangles.len(), report.has_warnings()),
        (2 + 4 * 12, false)
    );
    let (low, high) = mesh.bounds().unwrap();
    assert_eq!(
        (low, high),
        (Vec3::new(-4.0, 0.0, -4.0), Vec3::new(4.0, 0.6, 4.0))
    );
    // Scales of (±4, 0, ±4), which flatten each plate: of twelve triangles the four that stand
    // upright along an axis are lines, and welding drops those of two corners.
    let (mesh, report) = instances(r#""TRANSLATION":0,"SCALE":0"#).unwrap();
    assert_eq!(mesh.triangles.len() + report.dropped.triangles, 2 + 4 * 12);
    assert_eq!(mesh.bounds().unwrap().0, Vec3::new(-4.0, 0.0, -4.0));
    let error = instances(r#""TRANSLATION":0,"SCALE":2"#)
        .unwrap_err()
        .to_string();
    assert!(error.contains("attributes of different counts"), "{error}");
    let error = instances(r#""TRANSLATION":44"#).unwrap_err().to_string();
    assert!(error.contains("accessor 44, which is not there"), "{error}");
}

/// The floor's indices, as a strip and as a fan, in two runs.
#[test]
fn the_largest_index_begins_another_strip() {
    let text: String = CONTROL.split_whitespace().collect();
    let indices: [u16; 8] = [0, 2, 1, 65535, 0, 3, 2, 65535];
    let data: Vec<u8> = indices
        .iter()
        .flat_map(|index| index.to_le_bytes())
        .collect();
    let data = STANDARD.encode(data);
    let text = text
        .replace(
            r#"{"bufferView":1,"componentType":5123,"count":6,"#,
            r#"{"bufferView":4,"componentType":5123,"count":8,"#,
        )
        .replace(
            r#""bufferViews":["#,
            r#""bufferViews":[{"buffer":0,"byteLength":48},{"buffer":0,"byteLength":1},
                {"buffer":0,"byteOffset":60,"byteLength":96},
                {"buffer":0,"byteOffset":156,"byteLength":72},{"buffer":1,"byteLength":16},"#,
        )
        .replace(
            r#""buffers":["#,
            &format!(
                r#""extensionsRequired":["EXT_mesh_primitive_restart"],
                   "buffers":[{{"byteLength":16,"uri":"data:a;base64,{data}"}},"#
            ),
        )
        .replace(r#""buffer":1"#, r#""buffer":9"#)
        .replace(r#""buffer":0"#, r#""buffer":1"#)
        .replace(r#""buffer":9"#, r#""buffer":0"#);
    for mode in ["5", "6"] {
        let text = text.replacen(
            r#""indices":1"#,
            &format!(r#""indices":1,"mode":{mode}"#),
            1,
        );
        let parsed = parse_gltf(text.as_bytes(), Path::new("a.gltf"), MaterialUse::All);
        assert_plates(mode, &parsed.unwrap().0, ONE);
    }
}

#[test]
fn a_joint_that_is_not_there_is_named() {
    let path = faults().join("skin-pose/moved_node.gltf");
    let text = std::fs::read_to_string(path).unwrap();
    let text: String = text.split_whitespace().collect();
    let parse = |from: &str, to: &str| {
        assert!(text.contains(from), "{from}");
        let text = text.replace(from, to);
        parse_gltf(text.as_bytes(), Path::new("a.gltf"), MaterialUse::All)
    };
    // The joint is moved, turned inside out, and outside of the scene.
    let (mesh, _) = parse(
        r#"{"name":"joint"}"#,
        r#"{"translation":[1,0,0],"scale":[-1,1,1]}"#,
    )
    .unwrap();
    assert_plates("mirrored", &mesh, &[1.0]);
    let (mesh, _) = parse(r#""nodes":[0,1,2]"#, r#""nodes":[0,2]"#).unwrap();
    assert_plates("outside", &mesh, ONE);
    let error = parse(r#""joints":[1]"#, r#""joints":[1],"inverseBindMatrices":3"#).unwrap_err();
    assert!(error.to_string().contains("expected 16"), "{error}");
    let error = parse(r#""joints":[1]"#, r#""joints":[]"#)
        .unwrap_err()
        .to_string();
    assert!(
        error.contains("names joint 0, but its skin has 0"),
        "{error}"
    );
    let (mesh, report) = parse(r#","JOINTS_0":2,"WEIGHTS_0":3"#, "").unwrap();
    assert_plates("no joints", &mesh, &[2.5]);
    assert!(
        report.to_string().contains("has a skin, but no joints"),
        "{report}"
    );
    // A circle of nodes that only joints name.
    let circle = parse(r#"{"name":"joint"}"#, r#"{"children":[1]}"#);
    assert!(circle.is_err());
    assert_eq!(mesh.corner_normals(0)[0], DVec3::Y);
}
