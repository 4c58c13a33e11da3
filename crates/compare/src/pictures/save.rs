//! `run --save`: chooses which materials of a graph are read back, and writes them as files.
//!
//! ```no_run
//! use skiagraph_compare::pictures::{colours::ClipPlanes, save::{Decoding, Save, write}};
//! use skiagraph_gpu::Content;
//! use skiagraph_graph::Plan;
//! use skiagraph_scene::View;
//!
//! # type Done = Result<(), Box<dyn std::error::Error>>;
//! # fn save(plan: &Plan, view: &View, content: &Content) -> Done {
//! let save: Save = "depth=out/depth.png".parse()?;
//! let decoding = Decoding::new(plan, &save.capture.name(), ClipPlanes::new(view));
//! println!("{}", write(&save, content, &decoding)?);
//! # Ok(())
//! # }
//! ```

use crate::error::{CompareError, Result};
use crate::files::write::write_whole;
use crate::pictures::colours::ClipPlanes;
use crate::pictures::data::{Array, DataFormat};
use crate::pictures::material::Picture;
use crate::pictures::{buffer_csv, png};
use crate::wording::{bytes, size, thousands};
use itertools::Itertools;
use skiagraph_gpu::Content;
use skiagraph_graph::{Capture, Item, PartSummary, Plan};
use skiagraph_passes::names::{CAMERA, LIGHT};
use std::{collections::BTreeMap, path::PathBuf, str::FromStr};

/// Encoding of the file of a saved material.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Encoding {
    /// A picture for viewing, `.png`.
    Png,
    /// Bytes of the texels or items, rows tightly packed, `.bin`.
    Raw,
    /// A table with a line per item of a buffer, `.csv`.
    Csv,
    /// Values of a texture's texels, `.npy` or `.exr`.
    Data(DataFormat),
}

/// A material to save and its file, `MATERIAL[@PASS]=FILE.png|.bin|.csv|.npy|.exr`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Save {
    /// Name of the output or other material, and the pass after which it is read; without a pass it
    /// is read at the end of the frame.
    pub capture: Capture,
    /// Path of the file to write.
    pub file: PathBuf,
    /// Encoding, from the file's extension.
    pub encoding: Encoding,
}

impl FromStr for Save {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let expected = "expected MATERIAL=FILE.png or MATERIAL@PASS=FILE.bin, for example \
            visibility=shadow.png";
        let (what, file) = text.split_once('=').ok_or(expected)?;
        let (material, after) = match what.split_once('@') {
            Some((material, pass)) => (material, Some(pass.to_string())),
            None => (what, None),
        };
        if material.is_empty() || after.as_deref() == Some("") || file.is_empty() {
            return Err(expected.into());
        }
        let file = PathBuf::from(file);
        let extension = file.extension().unwrap_or_default().to_ascii_lowercase();
        let encoding = match extension.to_str() {
            Some("png") => Encoding::Png,
            Some("bin") => Encoding::Raw,
            Some("csv") => Encoding::Csv,
            Some("npy") => Encoding::Data(DataFormat::Npy),
            Some("exr") => Encoding::Data(DataFormat::Exr),
            _ => {
                return Err(format!(
                    "`{}` must end in .png (a picture), .npy or .exr (values of texels), .bin (raw \
                     bytes) or .csv (the items of a buffer)",
                    file.display()
                ));
            }
        };
        let mut capture = Capture::new(material);
        capture.after = after;
        Ok(Self {
            capture,
            file,
            encoding,
        })
    }
}

/// Returns the captures of `saves` whose names are not in `outputs`, the names of the outputs that
/// are read back anyway; each once, sorted by name.
pub fn captures(outputs: &[&str], saves: &[Save]) -> Vec<Capture> {
    let wanted = saves.iter().map(|save| &save.capture);
    let wanted = wanted.filter(|capture| !outputs.contains(&&*capture.name()));
    let wanted = wanted.sorted_by_key(|capture| capture.name()).dedup();
    wanted.cloned().collect()
}

/// Checks, before anything is rendered, that no buffer is to be saved as `.png`, `.npy` or `.exr`,
/// and no texture as `.csv`.
///
/// # Errors
/// A material that cannot be saved in this way; the message names the encodings that it can have.
pub fn check_encodings(plan: &Plan, saves: &[Save]) -> Result<()> {
    let outputs = plan.outputs();
    for save in saves {
        let name = save.capture.name();
        let Some(output) = outputs.iter().find(|output| output.name == name) else {
            continue;
        };
        let refused = match (save.encoding, output.format) {
            (Encoding::Png, None) => "is a buffer and has no picture; save it as .csv or .bin",
            (Encoding::Data(_), None) => "is a buffer and has no texels; save it as .csv or .bin",
            (Encoding::Csv, Some(_)) => {
                "is a texture and has no items; save it as .png, .npy, .exr or .bin"
            }
            _ => continue,
        };
        return Err(CompareError::Input(format!("`{name}` {refused}")));
    }
    Ok(())
}

/// Settings for decoding the content of a material.
#[derive(Clone, Default)]
pub struct Decoding {
    /// Clip planes of the camera, if the material may hold the camera's depths; `None` otherwise.
    pub planes: Option<ClipPlanes>,
    /// Layout of a buffer's items; `None` for a texture, or if no shader declares the layout.
    pub item: Option<Item>,
    /// Range of the mips, layers or items that the content has; `None` if it has all.
    pub part: Option<PartSummary>,
}

impl Decoding {
    /// Creates the settings for the output or capture `name` of a plan. `planes` are the camera's
    /// clip planes.
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

    /// Describes the part of a texture or buffer that `content` has, such as `layer 0 of 3, `;
    /// empty if it has all of it.
    pub fn part_text(&self, content: &Content) -> String {
        let Some(part) = &self.part else {
            return String::new();
        };
        let layer = match content {
            Content::Texture { .. } => "layer",
            Content::Buffer(_) => "item",
        };
        let mips = ("mip", &part.mips, part.of[0]);
        let layers = (layer, &part.layers, part.of[1]);
        let parts = [mips, layers].into_iter().filter(|(.., total)| *total > 1);
        let text = parts.map(|(what, range, total)| match range.len() {
            1 => format!("{what} {} of {total}, ", range.start),
            _ => format!("{what}s {} to {} of {total}, ", range.start, range.end - 1),
        });
        text.collect()
    }

    /// Returns the index, in the whole buffer, of the content's first item.
    pub fn first_item(&self) -> usize {
        let part = self.part.as_ref();
        part.map_or(0, |part| part.layers.start as usize)
    }
}

/// Returns the names under which the saved materials are read back (`MATERIAL` or `MATERIAL@PASS`),
/// each once, sorted.
pub fn names(saves: &[Save]) -> Vec<String> {
    let names = saves.iter().map(|save| save.capture.name());
    names.sorted().dedup().collect()
}

/// Returns the decoding of each save, in the order of `saves`. `planes` are the camera's clip
/// planes.
pub fn decodings(plan: &Plan, saves: &[Save], planes: ClipPlanes) -> Vec<Decoding> {
    let decoding = |save: &Save| Decoding::new(plan, &save.capture.name(), planes);
    saves.iter().map(decoding).collect()
}

/// Writes the saved materials of the graph named `graph`. Each is written when the returned
/// iterator reaches it; the item is the text of [`write`](fn@write). `decodings` are parallel to
/// `saves`; `contents` are by the names that [`names`] returns.
pub fn write_all<'a>(
    graph: &'a str,
    saves: &'a [Save],
    decodings: &'a [Decoding],
    contents: &'a BTreeMap<String, Content>,
) -> impl Iterator<Item = Result<String>> + 'a {
    saves.iter().zip(decodings).map(move |(save, decoding)| {
        let name = save.capture.name();
        let missing = || CompareError::Input(format!("`{graph}` has no `{name}` to save"));
        write(save, contents.get(&name).ok_or_else(missing)?, decoding)
    })
}

/// Writes a material's content into the file of a save. `reading` is the content's decoding.
/// Returns a line of text about the file.
///
/// # Errors
/// The content cannot be encoded in this way, or the file cannot be written.
pub fn write(save: &Save, content: &Content, reading: &Decoding) -> Result<String> {
    let (part, name) = (reading.part_text(content), &save.capture.material);
    let refused = |why| CompareError::Input(format!("`{name}` {why}"));
    let summary = match save.encoding {
        Encoding::Png => {
            let picture = Picture::new(name, content, reading.planes);
            let Picture { image, legend } = picture.map_err(refused)?;
            write_whole(&save.file, &png::encode(&save.file, &image)?)?;
            format!("{}, {part}{legend}", size(image.size))
        }
        Encoding::Data(format) => {
            let array = Array::from_content(content).map_err(refused)?;
            write_whole(&save.file, &array.encode(format).map_err(refused)?)?;
            format!("{part}{}", array.text())
        }
        Encoding::Csv => {
            let raw = content.bytes();
            let table = buffer_csv::to_csv(raw, reading.item.as_ref(), reading.first_item())
                .map_err(|error| CompareError::write(&save.file, error))?;
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
                    let sizes = parts.iter().map(|part| size(*part)).join(", ");
                    format!("{sizes} texels of {format:?}")
                }
                Content::Buffer(_) => "a buffer".into(),
            };
            format!("{}, {part}{what}", bytes(raw.len() as u64))
        }
    };
    Ok(format!("  saved {}: {summary}\n", save.file.display()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn saves_name_a_material_and_a_file_of_a_known_kind() {
        let save: Save = "shadow_map@create_shadow_map=out/a=b.PNG".parse().unwrap();
        assert_eq!(save.capture.material, "shadow_map");
        assert_eq!(save.capture.after.as_deref(), Some("create_shadow_map"));
        assert_eq!(
            (save.file, save.encoding),
            (PathBuf::from("out/a=b.PNG"), Encoding::Png)
        );
        for wrong in [
            "visibility",
            "visibility=a.jpg",
            "visibility=a",
            "=a.png",
            "v@=a.png",
            "v=",
        ] {
            assert!(wrong.parse::<Save>().is_err(), "{wrong}");
        }
    }
}
