//! `run --save`: what of a graph is read back, and how it is written.

use crate::args::values::{Encoding, Save};
use crate::error::CliError;
use crate::files::write::write_whole;
use crate::pictures::colours::ClipPlanes;
use crate::pictures::material::Picture;
use crate::pictures::{buffer_csv, png};
use crate::wording::{bytes, size, thousands};
use skiagraph_gpu::Content;
use skiagraph_graph::{Capture, Item, PartSummary, Plan};
use skiagraph_passes::names::{CAMERA, LIGHT};
use std::collections::BTreeMap;

/// Returns the capture to read back for a save.
pub fn capture(save: &Save) -> Capture {
    Capture {
        material: save.material.clone(),
        after: save.after.clone(),
    }
}

/// Returns captures of those saves that are not outputs of the graph anyway.
pub fn captures(outputs: &[&str], saves: &[Save]) -> Vec<Capture> {
    let wanted: BTreeMap<String, Capture> = saves
        .iter()
        .map(capture)
        .map(|capture| (capture.name(), capture))
        .collect();
    wanted
        .into_iter()
        .filter(|(name, _)| !outputs.contains(&name.as_str()))
        .map(|(_, capture)| capture)
        .collect()
}

/// Refuses the picture of a buffer and the items of a texture before anything is rendered.
///
/// # Errors
/// Names what it can be saved as.
pub fn check_encodings(plan: &Plan, saves: &[Save]) -> Result<(), CliError> {
    let outputs = plan.outputs();
    for save in saves {
        let name = capture(save).name();
        let Some(output) = outputs.iter().find(|output| output.name == name) else {
            continue;
        };
        let refused = match (save.encoding, output.format) {
            (Encoding::Png, None) => "is a buffer and has no picture; save it as .csv or .bin",
            (Encoding::Csv, Some(_)) => "is a texture and has no items; save it as .png or .bin",
            _ => continue,
        };
        return Err(CliError::Input(format!("`{name}` {refused}")));
    }
    Ok(())
}

/// How the contents of a material are to be read.
#[derive(Clone, Default)]
pub struct Decoding {
    /// The camera whose depths they are, if they are depths.
    pub planes: Option<ClipPlanes>,
    /// The items of a buffer.
    pub item: Option<Item>,
    /// Which of its mips, layers or items they are, if not all.
    pub part: Option<PartSummary>,
}

impl Decoding {
    /// Describes what this plan writes into the output or capture, seen between these planes.
    pub fn new(plan: &Plan, name: &str, planes: ClipPlanes) -> Self {
        let behind = plan.provided_behind(name);
        // A pass that also knows the light may well draw from there.
        let is_camera = behind.contains(CAMERA) && !behind.contains(LIGHT);
        Self {
            planes: is_camera.then_some(planes),
            item: plan.item(name),
            part: plan.part(name).filter(PartSummary::is_less),
        }
    }

    /// `layer 0 of 3, `: which part of a texture or buffer it is; nothing of a whole one.
    pub fn part_text(&self, content: &Content) -> String {
        let Some(PartSummary { mips, layers, of }) = &self.part else {
            return String::new();
        };
        let layer = match content {
            Content::Texture { .. } => "layer",
            Content::Buffer(_) => "item",
        };
        let parts = [("mip", mips, of[0]), (layer, layers, of[1])].into_iter();
        let parts = parts.filter(|(.., of)| *of > 1);
        let text = parts.map(|(what, range, of)| match range.len() {
            1 => format!("{what} {} of {of}, ", range.start),
            _ => format!("{what}s {} to {} of {of}, ", range.start, range.end - 1),
        });
        text.collect()
    }

    /// The number of the first item of a buffer.
    pub fn first_item(&self) -> usize {
        let part = self.part.as_ref();
        part.map_or(0, |part| part.layers.start as usize)
    }
}

/// Writes the file; returns what to say about it.
///
/// # Errors
/// There is no such picture, or the file cannot be written.
pub fn write(save: &Save, content: &Content, reading: &Decoding) -> Result<String, CliError> {
    let part = reading.part_text(content);
    let said = match save.encoding {
        Encoding::Png => {
            let picture = Picture::new(&save.material, content, reading.planes);
            let Picture { image, legend } = picture.map_err(|reason| {
                let name = &save.material;
                CliError::Input(format!("--save {name}: `{name}` {reason}"))
            })?;
            png::save(&save.file, &image)?;
            format!("{}, {part}{legend}", size(image.size))
        }
        Encoding::Csv => {
            let raw = content.bytes();
            let table = buffer_csv::to_csv(raw, reading.item.as_ref(), reading.first_item())
                .map_err(|error| CliError::write(&save.file, error))?;
            write_whole(&save.file, table.as_bytes())?;
            let (stride, what) = match &reading.item {
                Some(item) => (item.stride, "items as the shader declares them"),
                None => (4, "words, each read as u32, i32 and f32"),
            };
            let lines = thousands((raw.len() / stride.max(1)) as u64);
            format!("{part}{lines} {what}")
        }
        Encoding::Raw => {
            let raw = content.bytes();
            write_whole(&save.file, raw)?;
            let what = match content {
                Content::Texture { format, parts, .. } => {
                    let sizes: Vec<String> = parts.iter().map(|part| size(*part)).collect();
                    format!("{} texels of {format:?}", sizes.join(", "))
                }
                Content::Buffer(_) => "a buffer".into(),
            };
            format!("{}, {part}{what}", bytes(raw.len() as u64))
        }
    };
    Ok(format!("  saved {}: {said}\n", save.file.display()))
}
