//! The JSON Schemas: all presets and scene files are by them, and what is misspelt is not.

use jsonschema::Validator;
use serde_json::{Map, Value};
use std::{collections::BTreeSet, fs, path::Path};

/// RON as JSON: `Kind(field: value)` is `{"Kind": {"field": value}}`, a bare word a text, a tuple a
/// list.
struct Ron<'t>(&'t str);

impl<'t> Ron<'t> {
    fn json(text: &str) -> Value {
        let mut ron = Ron(text);
        let value = ron.value();
        ron.skip();
        assert_eq!(ron.0, "", "what stands behind the document");
        value
    }

    /// Passes white space and comments by.
    fn skip(&mut self) {
        loop {
            self.0 = self.0.trim_start();
            let Some(comment) = self.0.strip_prefix("//") else {
                return;
            };
            self.0 = comment.split_once('\n').map_or("", |(_, rest)| rest);
        }
    }

    fn next_is(&mut self, mark: char) -> bool {
        self.skip();
        let rest = self.0.strip_prefix(mark);
        self.0 = rest.unwrap_or(self.0);
        rest.is_some()
    }

    fn word(&mut self) -> &'t str {
        let is_part = |c: char| c.is_alphanumeric() || "_.-+".contains(c);
        let end = self.0.find(|c| !is_part(c)).unwrap_or(self.0.len());
        let (word, rest) = self.0.split_at(end);
        assert_ne!(word, "", "a value at {rest:.40}");
        self.0 = rest;
        word
    }

    fn string(&mut self) -> String {
        // Prose may be broken into lines, which JSON may not.
        let text = self.0.replace('\n', " ");
        let mut values = serde_json::Deserializer::from_str(&text).into_iter::<String>();
        let string = values.next().unwrap().unwrap();
        self.0 = &self.0[values.byte_offset()..];
        string
    }

    fn value(&mut self) -> Value {
        self.skip();
        match self.0.chars().next().unwrap() {
            '"' => self.string().into(),
            '[' => {
                self.0 = &self.0[1..];
                self.list(']').into()
            }
            '(' => self.brackets(),
            '{' => {
                self.0 = &self.0[1..];
                let mut map = Map::new();
                while !self.next_is('}') {
                    self.skip();
                    let key = self.string();
                    assert!(self.next_is(':'));
                    map.insert(key, self.value());
                    self.next_is(',');
                }
                map.into()
            }
            _ => {
                let word = self.word();
                if let Ok(value) = serde_json::from_str(&word.replace('_', "")) {
                    return value;
                }
                self.skip();
                if !self.0.starts_with('(') {
                    return word.into();
                }
                let body = match self.brackets() {
                    Value::Array(mut one) if one.len() == 1 => one.remove(0),
                    body => body,
                };
                Value::Object(Map::from_iter([(word.to_owned(), body)]))
            }
        }
    }

    fn list(&mut self, end: char) -> Vec<Value> {
        let mut list = Vec::new();
        while !self.next_is(end) {
            list.push(self.value());
            self.next_is(',');
        }
        list
    }

    /// A tuple, or fields with names.
    fn brackets(&mut self) -> Value {
        self.0 = &self.0[1..];
        self.skip();
        let inside = self.0;
        let is_name = |c: char| c.is_alphanumeric() || c == '_';
        let name = inside.trim_start_matches(is_name);
        let has_names = name.len() < inside.len() && name.trim_start().starts_with(':');
        if !has_names {
            return self.list(')').into();
        }
        let mut fields = Map::new();
        while !self.next_is(')') {
            self.skip();
            let name = self.word().to_owned();
            assert!(self.next_is(':'), "no colon behind {name}");
            fields.insert(name, self.value());
            self.next_is(',');
        }
        fields.into()
    }
}

fn schema(kind: &str) -> Value {
    let schema = match kind {
        "scenes" => skiagraph_scene::schema(),
        _ => skiagraph_graph::schema(&skiagraph_passes::registry()),
    };
    jsonschema::meta::validate(&schema).unwrap();
    schema
}

fn validator(kind: &str) -> Validator {
    jsonschema::validator_for(&schema(kind)).unwrap()
}

/// Lists what is wrong with a document, and where.
fn mistakes(schema: &Validator, text: &str) -> Vec<String> {
    let document = Ron::json(text);
    let errors = schema.iter_errors(&document);
    errors
        .map(|error| format!("{}: {error:.300}", error.instance_path()))
        .collect()
}

/// Asserts that the RON files of these folders are by a schema, and counts them.
fn all_are_by(schema: &Validator, folders: &[&str]) -> usize {
    let mut count = 0;
    for folder in folders {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR"))
            .join("../..")
            .join(folder);
        for entry in fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.extension().is_none_or(|ending| ending != "ron") {
                continue;
            }
            let text = fs::read_to_string(&path).unwrap();
            let mistakes = mistakes(schema, &text);
            assert!(mistakes.is_empty(), "{}: {mistakes:#?}", path.display());
            count += 1;
        }
    }
    count
}

#[test]
fn every_preset_is_a_document() {
    let folders = ["pipelines", "pipelines/shared", "tests/foreign/temporal"];
    let count = all_are_by(&validator("documents"), &folders);
    assert!(count > 25, "{count} documents");
}

#[test]
fn every_scene_file_is_by_the_schema_of_scenes() {
    let schema = validator("scenes");
    let count = all_are_by(&schema, &["scenes"]);
    assert!(count > 5, "{count} scenes");
    let right = r#"(
        format: 1, name: "a", mesh: Obj(file: "a.obj", quads: SecondFourth),
        lights: [Spot(name: "b", position: (0, 1, 0), direction: (0, -1, 0), cone_degrees: 9)],
        views: [(
            name: "c", eye: (0, 0, 0), direction: (0, 0, 1), fov_y_degrees: 9, near: 1, far: 2,
        )],
    )"#;
    assert_eq!(mistakes(&schema, right), [""; 0]);
    for (right_one, wrong) in [
        ("name: \"a\",", ""),
        ("file:", "fiel:"),
        ("Obj(", "Object("),
        ("SecondFourth", "Second"),
        ("Spot(", "Sport("),
        ("cone_degrees: 9", ""),
        ("lights:", "light:"),
        ("eye: (0, 0, 0)", "eye: (0, 0)"),
        ("near: 1", "near: \"1\""),
    ] {
        let text = right.replacen(right_one, wrong, 1);
        assert_ne!(text, right, "{right_one}");
        assert_ne!(mistakes(&schema, &text), [""; 0], "{wrong} is accepted");
    }
}

/// Collects the structs of a definition: itself, or the bodies of its variants.
fn structs(definition: &Value) -> Vec<&Value> {
    let is_kind = |name: &str| name.starts_with(char::is_uppercase);
    match (&definition["oneOf"], definition["properties"].as_object()) {
        (_, Some(fields)) if fields.keys().all(|name| is_kind(name)) => {
            fields.values().flat_map(structs).collect()
        }
        (_, Some(_)) => vec![definition],
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
    let schema = schema("scenes");
    let defs = &schema["$defs"];
    for (part, outer, inner) in [
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
        let bodies: Vec<&Value> = outer.into_iter().flat_map(structs).collect();
        let required = bodies
            .iter()
            .flat_map(|body| body["required"].as_array().unwrap());
        let required: BTreeSet<&str> = required.filter_map(Value::as_str).collect();
        assert_eq!(bold, required, "{text}");
        let inner = inner.into_iter().map(|name| &defs[name]);
        for body in bodies.into_iter().chain(inner) {
            for name in body["properties"].as_object().unwrap().keys() {
                assert!(
                    words.contains(name.as_str()),
                    "`{name}` is missing in {text}"
                );
            }
        }
    }
}

/// A document with one pass, material and param, into which mistakes are put.
const RIGHT: &str = r#"(
    format: 3,
    params: [F32(name: "gain", default: 1, min: 0)],
    materials: [
        Texture(name: "image", format: Rgba8Unorm, size: (64, 64), mips: All),
        Buffer(name: "rays", count: "image.width", grow: (counter: "image", max: 100)),
        Sampler(name: "smooth", filter: Linear),
    ],
    passes: [
        Raster(
            name: "draw", draw: "scene.indices.count", cull: Back, run: When("gain > 0"),
            color: [(target: "image", load: Clear(0, 0, 0, 1), blend: Alpha, write: rgb)],
        ),
        Compute(name: "count", dispatch: Groups(1, 2, 3)),
        Trace(name: "trace", rays: "rays", hits: "rays", count: "rays", mode: Any),
        Group(name: "two", repeat: 2, passes: [Clear(name: "zero", target: "image")]),
    ],
    outputs: ["image", (name: "also", material: "image")],
    claims: {"exact": true, "certain": (if: "gain > 0", because: "why")},
)"#;

#[test]
fn what_is_misspelt_is_no_document() {
    let schema = validator("documents");
    assert_eq!(mistakes(&schema, RIGHT), [""; 0]);
    let misspelt = [
        ("format: 3", "format: 1"),
        ("params:", "parameters:"),
        ("F32(", "Float("),
        ("min: 0", "minimum: 0"),
        (r#"name: "gain""#, r#"name: "Gain""#),
        ("Rgba8Unorm", "Rgba8Unrom"),
        ("mips: All", "mip: All"),
        ("counter:", "count:"),
        ("filter: Linear", "filter: Lineal"),
        ("Raster(", "Rasterize("),
        ("cull: Back", "cull: Backs"),
        ("Clear(0, 0, 0, 1)", "Clean(0, 0, 0, 1)"),
        ("blend: Alpha", "blend: Alhpa"),
        ("write: rgb", "write: rgx"),
        ("run: When(", "run: If("),
        ("Groups(1, 2, 3)", "Groups(1, 2)"),
        ("mode: Any", "mode: First"),
        (r#"Trace(name: "trace","#, "Trace("),
        ("repeat: 2", "repeats: 2"),
        (r#"Clear(name: "zero""#, r#"Clear(nam: "zero""#),
        (r#"material: "image")"#, r#"of: "image")"#),
        ("because:", "reason:"),
    ];
    for (right, wrong) in misspelt {
        let text = RIGHT.replacen(right, wrong, 1);
        assert_ne!(text, RIGHT, "{right}");
        assert_ne!(mistakes(&schema, &text), [""; 0], "{wrong} is accepted");
    }
}
