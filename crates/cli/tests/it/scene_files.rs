//! Scene files: `skiagraph schema scenes` against their page, and what is told of a broken one.

use crate::support::skiagraph;
use serde_json::Value;
use std::{collections::BTreeSet, fs, path::Path};

/// Collects the structs of a definition: itself, or the bodies of its variants.
fn structs(of: &Value) -> Vec<&Value> {
    let is_kind = |name: &str| name.starts_with(char::is_uppercase);
    match (&of["oneOf"], of["properties"].as_object()) {
        (_, Some(fields)) if fields.keys().all(|name| is_kind(name)) => {
            fields.values().flat_map(structs).collect()
        }
        (_, Some(_)) => vec![of],
        (Value::Array(several), None) => several.iter().flat_map(structs).collect(),
        _ => Vec::new(),
    }
}

/// `docs/scenes.md` has every field of scene files under its heading, in bold those that must be
/// given.
#[test]
fn the_page_of_scenes_has_every_field() {
    let page = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/scenes.md");
    let page = fs::read_to_string(page).unwrap();
    let fields = page.split("## Every field\n").nth(1).unwrap();
    let schema = skiagraph(Path::new("."), "schema scenes").stdout;
    let schema: Value = serde_json::from_slice(&schema).unwrap();
    let defs = &schema["$defs"];
    for (part, of, inner) in [
        (0, vec![&schema], vec![]),
        (1, vec![&defs["Mesh"]], vec![]),
        (2, vec![&defs["NamedLight"]], vec![]),
        (3, vec![&defs["View"]], vec![]),
        (
            4,
            vec![&defs["Path"], &defs["Motion"]],
            vec!["Key", "LightKey", "RigidKey"],
        ),
    ] {
        let text = fields.split("\n### ").nth(part).unwrap();
        let code = text.split('`').skip(1).step_by(2);
        let word = |c: char| !c.is_ascii_lowercase() && c != '_';
        let words: BTreeSet<&str> = code.flat_map(|code| code.split(word)).collect();
        let bold: BTreeSet<&str> = text
            .split("**`")
            .skip(1)
            .filter_map(|rest| rest.split("`**").next())
            .collect();
        let of: Vec<&Value> = of.into_iter().flat_map(structs).collect();
        let required = of.iter().flat_map(|of| of["required"].as_array().unwrap());
        let required: BTreeSet<&str> = required.filter_map(Value::as_str).collect();
        assert_eq!(bold, required, "{text}");
        let inner = inner.into_iter().map(|name| &defs[name]);
        for of in of.into_iter().chain(inner) {
            for name in of["properties"].as_object().unwrap().keys() {
                assert!(
                    words.contains(name.as_str()),
                    "`{name}` is missing in {text}"
                );
            }
        }
    }
}

/// A scene file is told of as a document is, with the lines that are wrong.
#[test]
fn a_broken_scene_file_is_shown_in_its_lines() {
    let folder = tempfile::tempdir().unwrap();
    let scene = "(\n    format: 1,\n    name: \"a\",\n    mesh: Genrated(\"park\"),\n)";
    fs::write(folder.path().join("a.ron"), scene).unwrap();
    let output = skiagraph(folder.path(), "compare nsm --scene a.ron");
    assert_eq!(output.status.code(), Some(1));
    let told = String::from_utf8_lossy(&output.stderr);
    for part in [
        "╭─[a.ron:4:11]",
        "4 │     mesh: Genrated(\"park\"),",
        "did you mean `Generated`?",
        "a scene needs at least one view",
        "cannot load the scene `a.ron`",
    ] {
        assert!(told.contains(part), "{told}");
    }
}
