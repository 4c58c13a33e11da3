//! The JSON Schema of scene files (feature `schema`).

use crate::{camera::View, light_kind::NamedLightText, path::PathText, scene_file::SceneFile};
use schemars::{JsonSchema, SchemaGenerator};
use serde_json::{Value, json};
use skiagraph_located_ron::schema::plain;

/// Returns the JSON Schema (draft 2020-12) of scene files. It describes their RON as JSON:
/// `Kind(field: value)` is `{"Kind": {"field": value}}`, a bare word is a string, a tuple is an
/// array.
pub fn schema() -> Value {
    let mut generator = SchemaGenerator::default();
    let head = SceneFile::json_schema(&mut generator).to_value();
    let lights = generator.subschema_for::<Vec<NamedLightText>>().to_value();
    let views = generator.subschema_for::<Vec<View>>().to_value();
    let paths = generator.subschema_for::<Vec<PathText>>().to_value();
    let mut properties = head["properties"].clone();
    for (name, mut list, description) in [
        (
            "lights",
            lights,
            "Lights of all views that have none of their own.",
        ),
        ("views", views, "One at least, no two of one name."),
        (
            "paths",
            paths,
            "Ways that a camera takes, no two of one name.",
        ),
    ] {
        list["description"] = description.into();
        properties[name] = list;
    }
    let mut scene = json!({
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "Skiagraph scene",
        "type": "object",
        "properties": properties,
        "required": ["format", "name", "mesh", "views"],
        "oneOf": [{ "required": ["light"] }, { "required": ["lights"] }],
        "additionalProperties": false,
        "$defs": generator.take_definitions(true),
    });
    plain(&mut scene);
    scene
}
