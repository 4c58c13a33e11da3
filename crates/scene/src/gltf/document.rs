//! Parses and validates a document. Two mistakes on which the `gltf` crate panics are found before
//! it looks.

use gltf::{
    Document, Error, Gltf,
    json::{Root, mesh::Semantic, validation::Checked},
};

/// A place in the file, and what is wrong there.
pub(super) type Fault = (String, String);

/// The document of a file's bytes, and the buffer in it.
///
/// # Errors
/// What is wrong with it.
pub(super) fn parse(bytes: &[u8]) -> Result<(Document, Option<Vec<u8>>), Fault> {
    let parsed = Gltf::from_slice_without_validation(bytes);
    let Gltf { document, blob } = parsed.map_err(|why| refusal(&why))?;
    let root = document.into_json();
    check(&root)?;
    let document = Document::from_json(root).map_err(|why| refusal(&why))?;
    Ok((document, blob))
}

fn check(root: &Root) -> Result<(), Fault> {
    for (index, mesh) in root.meshes.iter().enumerate() {
        for (number, primitive) in mesh.primitives.iter().enumerate() {
            let positions = primitive
                .attributes
                .get(&Checked::Valid(Semantic::Positions));
            let count = root.accessors.len();
            if let Some(named) = positions.filter(|named| named.value() >= count) {
                let place = format!("mesh {index}, primitive {number}");
                let why = format!("POSITION is accessor {named}, but there are {count}");
                return Err((place, why));
            }
        }
    }
    for (index, image) in root.images.iter().enumerate() {
        let is_placed = match image.buffer_view {
            Some(_) => image.mime_type.is_some(),
            None => image.uri.is_some(),
        };
        if !is_placed {
            let why = "it has neither a uri nor a bufferView with its mimeType";
            return Err((format!("image {index}"), why.to_owned()));
        }
    }
    Ok(())
}

/// Where the `gltf` crate found a mistake, and what it is.
fn refusal(error: &Error) -> (String, String) {
    match error {
        Error::Validation(mistakes) => {
            let (place, what) = match mistakes.first() {
                Some((place, what)) => (place.to_string(), what.to_string()),
                None => (String::new(), String::new()),
            };
            let more = match mistakes.len() {
                0 | 1 => String::new(),
                count => format!(" (and {} more)", count - 1),
            };
            let required = place.starts_with("extensionsRequired");
            let reason = match required {
                true => format!(
                    "the file cannot be read without an extension that this program does not \
                     know{more}; export it without"
                ),
                false => format!("{what}{more}"),
            };
            (place, reason)
        }
        Error::Deserialize(why) => ("its JSON".to_owned(), why.to_string()),
        Error::Binary(why) => ("its binary container".to_owned(), why.to_string()),
        other => ("the file".to_owned(), other.to_string()),
    }
}
