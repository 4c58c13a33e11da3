//! Summaries of a plan's passes and outputs, for lists that people read.

use crate::document::Document;
use crate::errors::plan::OutputError;
use crate::provided_kind::ProvidedKind;
use crate::resource::{ResourceKind, Target};

/// Name and kind of a pass that a plan runs.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PassSummary {
    /// Full name of the pass: the name in the document, with the names of the groups and includes
    /// around it in front, `blur.x`, and the index of a repetition behind, `fill[0]`. An include
    /// without a name counts by the name of its file.
    pub name: String,
    /// Kind of the pass, as the document writes it, such as `Compute`; [`CAPTURE`](crate::CAPTURE)
    /// for a pass that planning added.
    pub kind: String,
}

/// Name, format and size of an output or capture ([`Capture`](crate::Capture)) that can be read
/// back after a frame.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct OutputSummary {
    /// Name of the output, or of the capture ([`Capture::name`](crate::Capture::name)), by which it
    /// is read back.
    pub name: String,
    /// Format of the texture that holds the output or [capture](crate#terms); `None` for a buffer.
    pub format: Option<wgt::TextureFormat>,
    /// Width and height in texels of the first mip that is read back of a texture; for a buffer
    /// `[n, 1]`, where n is the number of bytes that are read back.
    pub size: [u32; 2],
    /// Number of layers of the output or [capture](crate#terms), or of slices of a 3D texture, that
    /// are read back; 1 for a buffer.
    pub layers: u32,
}

impl OutputSummary {
    pub(super) fn new(name: &str, target: &Target, kind: &ResourceKind) -> Self {
        let (format, size) = match kind {
            ResourceKind::Texture(texture) => (
                Some(texture.format),
                texture.mip_size(target.part.mips.start),
            ),
            ResourceKind::Buffer(buffer) => {
                let items = target.part.items();
                let bytes = items.map_or(buffer.bytes, |items| {
                    buffer.stride.saturating_mul(items.len() as u64)
                });
                (None, [u32::try_from(bytes).unwrap_or(u32::MAX), 1])
            }
            _ => (None, [0, 0]),
        };
        Self {
            name: name.to_owned(),
            format,
            size,
            layers: match target.part.layers.len() {
                layers if format.is_some() => layers as u32,
                _ => 1,
            },
        }
    }
}

/// Returns an error if a light is of a kind that the document does not take. `kinds` holds provided
/// resources by their names, each with its kind. A document takes the first kind, unless its
/// section `lights` lists others.
pub(super) fn refused_light<N: AsRef<str>>(
    document: &Document,
    kinds: impl IntoIterator<Item = (N, ProvidedKind)>,
) -> Option<OutputError> {
    let kinds = kinds.into_iter();
    let lights = kinds.filter(|(name, _)| is_light(name.as_ref()));
    let takes = |kind: &ProvidedKind| {
        if document.lights.is_empty() {
            kind.number == 0
        } else {
            let mut lights = document.lights.iter();
            lights.any(|word| word.as_str() == kind.word())
        }
    };
    let kind = lights.map(|(_, kind)| kind).find(|kind| !takes(kind))?;
    let words = document.lights.iter().map(|word| word.value.to_string());
    let takes = if document.lights.is_empty() {
        let first = kind.words.iter().take(1);
        first.map(|word| (*word).to_owned()).collect()
    } else {
        words.collect()
    };
    let place = document.lights.first().map(|word| word.span.clone());
    Some(OutputError::Light {
        graph: document.file.name.to_string(),
        kind: kind.word(),
        takes,
        place: place.unwrap_or_else(|| document.file.span(0..0)),
    })
}

/// True for the name `light`, and for names of items of `lights`.
pub(super) fn is_light(name: &str) -> bool {
    name == "light" || name.starts_with("lights.")
}
