//! glTF import: what becomes of good files, and what is said about broken ones.

use base64::{Engine, engine::general_purpose::STANDARD};
use glam::{DVec3, Vec2, Vec3};
use proptest::prelude::*;
use skiagraph_scene::{ImportReport, MaterialUse, Mesh, SceneError, Wrap, gltf::parse_gltf};
use std::path::Path;

fn parse(text: &str) -> Result<(Mesh, ImportReport), SceneError> {
    parse_bytes(text.as_bytes(), "plant.gltf")
}

fn parse_bytes(bytes: &[u8], name: &str) -> Result<(Mesh, ImportReport), SceneError> {
    parse_gltf(bytes, Path::new(name), MaterialUse::All)
}

fn error(text: &str) -> String {
    parse(text).unwrap_err().to_string()
}

/// Positions, texture coordinates and indices of a square.
fn square() -> Vec<u8> {
    let positions = [[0., 0., 0.], [1., 0., 0.], [1., 1., 0.], [0., 1., 0f32]];
    let uvs = [[0., 1.], [1., 1.], [1., 0.], [0., 0f32]];
    let mut bytes: Vec<u8> = positions
        .concat()
        .iter()
        .flat_map(|x| x.to_le_bytes())
        .collect();
    bytes.extend(uvs.concat().iter().flat_map(|x| x.to_le_bytes()));
    bytes.extend([0u16, 1, 2, 0, 2, 3].iter().flat_map(|x| x.to_le_bytes()));
    bytes
}

/// A picture of 2 × 1 texels, the right one transparent.
fn picture() -> Vec<u8> {
    let texels = image::RgbaImage::from_raw(2, 1, vec![255, 0, 0, 255, 0, 255, 0, 0]).unwrap();
    let mut bytes = std::io::Cursor::new(Vec::new());
    texels
        .write_to(&mut bytes, image::ImageFormat::Png)
        .unwrap();
    bytes.into_inner()
}

/// A document of a masked square; `buffer` is what holds its bytes.
fn document(buffer: &str) -> String {
    let image = STANDARD.encode(picture());
    format!(
        r#"{{
  "asset": {{"version": "2.0"}},
  "scene": 0,
  "scenes": [{{"nodes": [0]}}],
  "nodes": [
    {{"name": "stem", "translation": [0, 10, 0], "children": [1]}},
    {{"name": "leaf", "scale": [2, 2, -2], "mesh": 0}}
  ],
  "meshes": [{{"primitives": [{{
    "attributes": {{"POSITION": 0, "TEXCOORD_0": 1}}, "indices": 2, "material": 0
  }}]}}],
  "materials": [{{
    "name": "leaf", "doubleSided": true, "alphaMode": "MASK", "alphaCutoff": 0.3,
    "pbrMetallicRoughness": {{
      "baseColorFactor": [0.5, 1, 1, 1], "baseColorTexture": {{"index": 0}}
    }}
  }}],
  "textures": [{{"source": 0, "sampler": 0}}],
  "samplers": [{{"wrapS": 33071, "wrapT": 33648}}],
  "images": [{{"uri": "data:image/png;base64,{image}"}}],
  "accessors": [
    {{"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3",
      "min": [0, 0, 0], "max": [1, 1, 0]}},
    {{"bufferView": 0, "byteOffset": 48, "componentType": 5126, "count": 4, "type": "VEC2"}},
    {{"bufferView": 1, "componentType": 5123, "count": 6, "type": "SCALAR"}}
  ],
  "bufferViews": [
    {{"buffer": 0, "byteLength": 80}},
    {{"buffer": 0, "byteOffset": 80, "byteLength": 12}}
  ],
  "buffers": [{{"byteLength": 92{buffer}}}]
}}"#
    )
}

fn with_data_uri() -> String {
    let data = STANDARD.encode(square());
    document(&format!(
        r#", "uri": "data:application/octet-stream;base64,{data}""#
    ))
}

/// The same as a binary file.
fn glb() -> Vec<u8> {
    let mut json = document("").into_bytes();
    json.resize(json.len().next_multiple_of(4), b' ');
    let blob = square();
    let mut bytes = b"glTF".to_vec();
    let word = |number: usize| (number as u32).to_le_bytes();
    bytes.extend(word(2));
    bytes.extend(word(12 + 8 + json.len() + 8 + blob.len()));
    bytes.extend(word(json.len()));
    bytes.extend(b"JSON");
    bytes.extend(&json);
    bytes.extend(word(blob.len()));
    bytes.extend(b"BIN\0");
    bytes.extend(blob);
    bytes
}

#[test]
fn a_masked_leaf_is_placed_coloured_and_cut_out() {
    let (mesh, _) = parse(&with_data_uri()).unwrap();
    assert_eq!((mesh.triangles.len(), mesh.positions.len()), (2, 4));
    assert_eq!(
        mesh.bounds(),
        Some((Vec3::new(0., 10., 0.), Vec3::new(2., 12., 0.)))
    );
    // The node mirrors it: wound the other way in the file's order, so that its front stays the
    // front.
    assert_eq!(mesh.corner_normals(0), [DVec3::NEG_Z; 3]);
    assert_eq!(mesh.groups[0].name, "leaf");
    let surfaces = &mesh.surfaces;
    assert!(surfaces.is_double_sided(0));
    let mask = surfaces.mask(0).unwrap();
    assert_eq!((mask.size, mask.opaque[0]), ([2, 1], 0b01));
    assert_eq!(mask.wrap, [Wrap::Clamp, Wrap::Mirror]);
    assert!(surfaces.uvs.contains(&Vec2::new(1.0, 1.0)));
    assert_eq!(surfaces.base_color(0, [1.0, 0.0, 0.0]), [0.5, 0.0, 0.0]);
}

#[test]
fn a_binary_file_is_the_same() {
    let (binary, _) = parse_bytes(&glb(), "plant.glb").unwrap();
    let (text, _) = parse(&with_data_uri()).unwrap();
    assert_eq!(binary.positions, text.positions);
    assert_eq!(binary.triangles, text.triangles);
    assert_eq!(binary.surfaces.mask(1), text.surfaces.mask(1));
}

#[test]
fn broken_files_say_where_and_why() {
    let good = with_data_uri();
    let broken = |from: &str, to: &str| {
        assert!(good.contains(from), "{from}");
        error(&good.replace(from, to))
    };
    let errors = [
        error(&good[..good.len() / 2]),
        broken(r#""count": 6"#, r#""count": 60"#),
        broken(r#""byteLength": 92"#, r#""byteLength": 920"#),
        broken(
            r#""byteOffset": 80, "byteLength": 12"#,
            r#""byteOffset": 90, "byteLength": 12"#,
        ),
        broken(
            r#""count": 4, "type": "VEC3""#,
            r#""count": 3, "type": "VEC3""#,
        ),
        broken(r#""POSITION": 0, "#, ""),
        broken(r#""indices": 2"#, r#""indices": 7"#),
        broken(r#""mesh": 0"#, r#""mesh": 0, "children": [0]"#),
        broken(r#""scale": [2, 2, -2]"#, r#""scale": [2e38, 2e38, 2e38]"#),
        broken(
            r#""asset""#,
            r#""extensionsRequired": ["ACME_magic"], "asset""#,
        ),
        broken("data:image/png;base64,", "data:image/png;base64,AAAA"),
        broken("data:image/png;base64,", "data:image/png,"),
        error(&document(r#", "uri": "nowhere.bin""#)),
        error(&document("")),
        error("{\"asset\": {\"version\": \"2.0\"}}"),
    ];
    insta::assert_snapshot!(errors.join("\n"));
    let cut = parse_bytes(&glb()[..200], "plant.glb").unwrap_err();
    assert!(cut.to_string().starts_with("plant.glb: "), "{cut}");
}

#[test]
fn a_vertex_that_is_not_finite_is_refused() {
    let mut bytes = square();
    bytes[16..20].copy_from_slice(&f32::NAN.to_le_bytes());
    let data = STANDARD.encode(bytes);
    let text = document(&format!(
        r#", "uri": "data:application/octet-stream;base64,{data}""#
    ));
    assert_eq!(
        error(&text),
        "plant.gltf: mesh 0, primitive 0: vertex 1 is at [NaN, NaN, NaN], which is not finite"
    );
}

proptest! {
    /// No damage makes it panic.
    #[test]
    fn damage_is_refused_or_harmless(
        at in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..6),
        cut in any::<prop::sample::Index>(),
        binary in any::<bool>(),
    ) {
        let mut bytes = if binary { glb() } else { with_data_uri().into_bytes() };
        for (index, value) in at {
            let length = bytes.len();
            bytes[index.index(length)] = value;
        }
        if cut.index(4) == 0 {
            bytes.truncate(cut.index(bytes.len()));
        }
        if let Err(error) = parse_bytes(&bytes, "plant.glb") {
            prop_assert!(error.to_string().starts_with("plant.glb: "), "{}", error);
        }
    }

    /// Numbers of the document, replaced one by one.
    #[test]
    fn any_number_is_refused_or_harmless(which in 0usize..80, number in prop_oneof![
        Just("-1".to_owned()), Just("0".to_owned()), Just("4294967295".to_owned()),
        Just("18446744073709551615".to_owned()), Just("1e39".to_owned()), Just("5".to_owned()),
    ]) {
        let text = with_data_uri();
        let places: Vec<(usize, &str)> = text.match_indices(": ").collect();
        let at = places[which % places.len()].0 + 2;
        let digits = text[at..].chars().take_while(char::is_ascii_digit).count();
        prop_assume!(digits > 0);
        let damaged = format!("{}{number}{}", &text[..at], &text[at + digits..]);
        if let Err(error) = parse(&damaged) {
            prop_assert!(error.to_string().starts_with("plant.gltf: "), "{}", error);
        }
    }
}

#[test]
fn extras_give_roles_in_shadows() {
    use skiagraph_scene::Shadows::{Both, Casts, Neither, Receives};
    let role = |node: &str, mesh: &str| {
        let node = format!("\"mesh\": 0, \"extras\": {node}}}");
        let mesh = format!("\"meshes\": [{{\"extras\": {mesh}, ");
        let text = with_data_uri().replace("\"mesh\": 0}", &node);
        let (mesh, report) = parse(&text.replace("\"meshes\": [{", &mesh)).unwrap();
        assert_eq!(mesh.surfaces.shadows(0), mesh.surfaces.shadows(1));
        (mesh.surfaces.shadows(0), report.remarks.join("\n"))
    };
    for (node, mesh, expected) in [
        ("{}", "{}", Both),
        ("{\"casts\": false}", "{}", Receives),
        ("{\"receives\": false}", "{\"casts\": false}", Casts),
        (
            "{\"colour\": 1}",
            "{\"casts\": 0, \"receives\": 0}",
            Neither,
        ),
        ("{\"casts\": true}", "{\"casts\": false}", Both),
    ] {
        assert_eq!(role(node, mesh), (expected, String::new()), "{node} {mesh}");
    }
    let (shadows, remarks) = role("{\"casts\": \"no\"}", "{}");
    let remark = "node 1: its extras say casts: \"no\", expected true or false";
    assert_eq!((shadows, remarks.as_str()), (Both, remark));
}
