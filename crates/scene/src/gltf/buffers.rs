//! The bytes of buffers and images: in the file itself, in data URIs, or in files beside it.

use super::beside::Beside;
use crate::error::beginning;
use crate::limit::Limit;
use crate::text::{file_in, line_text};
use base64::{Engine, engine::general_purpose::STANDARD};
use percent_encoding::percent_decode_str;
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Some hundred million triangles.
pub(super) const GLTF_FILE: Limit = Limit {
    of: "a glTF file or one of its buffers",
    mib: 2048,
    way_out: "split it",
};

/// The bytes of a data URI.
///
/// # Errors
/// It is none of base64.
pub(super) fn data_uri(uri: &str) -> Option<Result<Vec<u8>, String>> {
    let rest = uri.strip_prefix("data:")?;
    let Some((kind, text)) = rest.split_once(',') else {
        return Some(Err("the data URI has no comma before its data".to_owned()));
    };
    if !kind.ends_with(";base64") {
        let kind = beginning(kind);
        return Some(Err(format!("the data URI is {kind:?}, expected base64")));
    }
    let decoded = STANDARD.decode(text.trim_end());
    Some(decoded.map_err(|why| format!("the data URI is not base64: {why}")))
}

/// The file that a URI names, whose odd characters are written as `%20`. Its bytes may be in any
/// encoding.
pub(super) fn path_of(folder: &Path, uri: &str) -> PathBuf {
    let decoded: Vec<u8> = percent_decode_str(uri).collect();
    file_in(folder, &line_text(&decoded))
}

/// The bytes that a URI holds, or those of the file that it names.
///
/// # Errors
/// It holds no base64, or the file cannot be read.
pub(super) fn load(folder: &Path, uri: &str) -> Result<Vec<u8>, String> {
    if let Some(decoded) = data_uri(uri) {
        return decoded;
    }
    let path = path_of(folder, uri);
    let read = GLTF_FILE.read(&path);
    read.map_err(|why| format!("cannot read {}: {why}", path.display()))
}

/// The bytes of a document's buffers.
pub(super) struct Buffers {
    /// By their numbers; those that are not needed have none.
    pub bytes: Vec<Arc<[u8]>>,
    /// Distances of a buffer view's items, where the document does not tell.
    pub strides: HashMap<usize, usize>,
}

impl Buffers {
    /// The bytes of a view; `None` if it reaches beyond its buffer.
    pub fn view(&self, view: &gltf::buffer::View<'_>) -> Option<&[u8]> {
        let end = view.offset().checked_add(view.length())?;
        self.bytes
            .get(view.buffer().index())?
            .get(view.offset()..end)
    }
}

/// The bytes of all buffers that are needed of a document.
///
/// # Errors
/// The buffer's place, and what is wrong with it.
pub(super) fn read(
    document: &gltf::Document,
    mut blob: Option<Vec<u8>>,
    beside: &Beside,
    file: &Path,
) -> Result<Buffers, (String, String)> {
    let folder = file.parent().unwrap_or(Path::new(""));
    let bytes = document
        .buffers()
        .map(|buffer| {
            if !beside.buffers.contains(&buffer.index()) {
                return Ok([].into());
            }
            let fail = |why| (format!("buffer {}", buffer.index()), why);
            let bytes = match buffer.source() {
                gltf::buffer::Source::Bin => blob.take().ok_or_else(|| {
                    fail("it names no file, and the file holds no binary chunk".to_owned())
                })?,
                gltf::buffer::Source::Uri(uri) => load(folder, uri).map_err(fail)?,
            };
            if bytes.len() < buffer.length() {
                return Err(fail(format!(
                    "it should have {} bytes, but only {} are there: the file is cut off",
                    buffer.length(),
                    bytes.len()
                )));
            }
            Ok(bytes.into())
        })
        .collect::<Result<_, _>>()?;
    Ok(Buffers {
        bytes,
        strides: beside.strides.clone(),
    })
}
