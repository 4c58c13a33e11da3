//! Parses and validates a document. Mistakes on which the `gltf` crate panics, and what it has no
//! need to refuse, are seen to before it looks.

use super::beside::Beside;
use super::container;
use super::fault::{Fault, of_another_version};
use super::placements::Placements;
use super::prepare::prepare;
use crate::{border::caught, material_use::MaterialUse, text::line_text};
use gltf::{
    Document, Error,
    json::{Root, deserialize, mesh::Semantic, validation::Checked},
};
use serde_json::{Value, json};

/// Most values in the JSON: each takes many times its text.
const MOST_VALUES: usize = 1 << 25;

/// A file, read as far as it needs no other files.
pub(super) struct Parsed {
    pub document: Document,
    /// The buffer in a binary file.
    pub blob: Option<Vec<u8>>,
    pub beside: Beside,
    pub placements: Placements,
}

/// The document of a file's bytes.
///
/// # Errors
/// The first mistake.
pub(super) fn parse(bytes: &[u8], materials: MaterialUse) -> Result<Parsed, Fault> {
    let (text, blob) = container::split(bytes)?;
    let values = text.iter().filter(|&&byte| byte == b',').count();
    if values > MOST_VALUES {
        let why = format!("it has {values} values, {MOST_VALUES} at most: split the file");
        return Err(("its JSON".to_owned(), why));
    }
    // JSON is UTF-8; some exporters write names in other encodings.
    let text = line_text(&text);
    let mut value: Value = deserialize::from_str(&text).map_err(|why| in_json(&why))?;
    check_version(&mut value)?;
    let placements = Placements::read(&value);
    let beside = prepare(&mut value, materials)?;
    let root: Root = deserialize::from_value(value).map_err(|why| {
        // The text of the file tells the line, where it has the same mistake.
        let reread: Result<Root, _> = deserialize::from_str(&text);
        in_json(&reread.err().unwrap_or(why))
    })?;
    check(&root)?;
    let document = caught("gltf", || Document::from_json(root));
    let document = document.map_err(|why| ("the file".to_owned(), why))?;
    Ok(Parsed {
        document: document.map_err(|why| refusal(&why))?,
        blob: blob.map(<[u8]>::to_vec),
        beside,
        placements,
    })
}

fn in_json(why: &serde_json::Error) -> Fault {
    let cut = if why.is_eof() {
        ": the file is cut off"
    } else {
        ""
    };
    ("its JSON".to_owned(), format!("{why}{cut}"))
}

/// Refuses other versions than 2; in 1.0 lists were objects.
fn check_version(root: &mut Value) -> Result<(), Fault> {
    let fail = |version: &str| Err(("asset".to_owned(), of_another_version(version)));
    let value_at = |field| match root.pointer(field) {
        Some(Value::String(version)) => Some(version.clone()),
        Some(Value::Number(version)) => Some(version.to_string()),
        _ => None,
    };
    let is_two = |version: &String| version == "2" || version.starts_with("2.");
    let is_one = ["nodes", "meshes"].iter().any(|it| root[*it].is_object());
    match (value_at("/asset/version"), value_at("/asset/minVersion")) {
        (Some(version), _) if !is_two(&version) => return fail(&version),
        (_, Some(least)) if least != "2.0" => return fail(&least),
        (None, _) if is_one => return fail("1.0"),
        (None, _) => return Ok(()),
        (Some(_), _) => {}
    }
    root["asset"] = json!({"version": "2.0"});
    Ok(())
}

fn check(root: &Root) -> Result<(), Fault> {
    for (index, mesh) in root.meshes.iter().enumerate() {
        for (number, primitive) in mesh.primitives.iter().enumerate() {
            let attributes = &primitive.attributes;
            let positions = attributes.get(&Checked::Valid(Semantic::Positions));
            let count = root.accessors.len();
            if let Some(named) = positions.filter(|named| named.value() >= count) {
                let place = format!("mesh {index}, primitive {number}");
                let why = format!("POSITION is accessor {named}, but there are {count}");
                return Err((place, why));
            }
        }
    }
    Ok(())
}

/// Where the `gltf` crate found a mistake, and what it is.
fn refusal(error: &Error) -> Fault {
    match error {
        Error::Validation(mistakes) => {
            let first = mistakes.first();
            let first = first.map(|(place, what)| (place.to_string(), what.to_string()));
            let (place, what) = first.unwrap_or_default();
            let more = match mistakes.len() {
                0 | 1 => String::new(),
                count => format!(" (and {} more)", count - 1),
            };
            (place, format!("{what}{more}"))
        }
        other => ("the file".to_owned(), other.to_string()),
    }
}
