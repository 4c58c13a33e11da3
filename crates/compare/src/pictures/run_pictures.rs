//! Draws the pictures of a run and of the reference, and names their files.
//!
//! ```
//! use skiagraph_compare::pictures::run_pictures::{graph_name, numbered, reference_name};
//! use std::path::Path;
//!
//! assert_eq!(numbered(Path::new("out/lit.png"), 7), Path::new("out/lit.0007.png"));
//! println!("{}, {}", reference_name("main", [64, 48]), graph_name("my/method.ron"));
//! ```

use crate::error::{CompareError, Result};
use crate::files::write::write_whole;
use crate::graphs::ground_truth::Judgement;
use crate::graphs::method::Method;
use crate::graphs::shadow_method::Outputs;
use crate::pictures::data::{self, DataFormat};
use crate::pictures::png;
use crate::records::results::Images;
use crate::wording::size;
use skiagraph_reference::{Error, Footprint, GroundTruth, GroundTruthPixels, Image};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// A picture or data file in memory. It is written together with the figures of its run.
#[derive(Clone)]
pub struct PictureFile {
    /// File name in the folder of the results.
    pub name: String,
    /// Content of the file.
    pub bytes: Vec<u8>,
}

/// Writes pictures into a folder that is there, each whole or not at all.
///
/// # Errors
/// A picture that cannot be written.
pub fn write_pictures(folder: &Path, files: &[PictureFile]) -> Result<()> {
    let mut files = files.iter();
    files.try_for_each(|file| write_whole(&folder.join(&file.name), &file.bytes))
}

/// View and frame that a method's pictures show, and the beginning of their file names.
pub struct PicturePlace<'a> {
    /// Beginning of the file names of the method's pictures, from [`stem`].
    pub stem: String,
    /// Name of the view, camera path or stress case.
    pub view: &'a str,
    /// Index of the frame of a camera path, from 0; `None` for a still view or stress case.
    pub frame: Option<usize>,
}

impl PicturePlace<'_> {
    /// Draws the scene, shaded with the light that each pixel shows.
    ///
    /// # Errors
    /// Another size than the reference's; a picture that cannot be encoded.
    pub fn shaded(&self, shown: &[f32], truth: &GroundTruthPixels) -> Result<PictureFile> {
        self.picture(&self.own("shaded"), Image::shaded(shown, truth))
    }

    /// Name of a kind of the method's pictures, without the frame.
    fn own(&self, kind: &str) -> String {
        format!("{}-{kind}.png", self.stem)
    }

    /// Encodes a picture, under a name to which that of the frame is added.
    fn picture(&self, name: &str, image: Result<Image, Error>) -> Result<PictureFile> {
        let name = self.file(name.to_owned());
        let image =
            image.map_err(|error| CompareError::Input(format!("no picture {name}: {error}")))?;
        let bytes = png::encode(Path::new(&name), &image)?;
        Ok(PictureFile { name, bytes })
    }

    fn file(&self, name: String) -> String {
        match self.frame {
            Some(frame) => numbered(Path::new(&name), frame).display().to_string(),
            None => name,
        }
    }
}

/// Draws the pictures of a method's frame and of the [reference](crate#terms). `footprints` has one
/// entry per pixel, row by row from the top left: its footprint in the shadow map; with it,
/// pictures of the texels per pixel are drawn as well. Returns the names of the files, and the
/// files to write.
///
/// # Errors
/// Outputs of another size than the reference; a picture that cannot be encoded.
pub fn draw_pictures(
    place: &PicturePlace,
    ground_truth: &GroundTruth,
    (outputs, judgement): (&Outputs, &Judgement),
    footprints: Option<&[Option<Footprint>]>,
) -> Result<(Images, Vec<PictureFile>)> {
    let counts = &judgement.counts;
    let (truth, visibility, status) = (&ground_truth.pixels, &outputs.shown(), &outputs.status);
    let mut files = Vec::new();
    let mut draw = |name: String, image: Result<Image, Error>| -> Result<String> {
        files.push(place.picture(&name, image)?);
        Ok(files[files.len() - 1].name.clone())
    };
    let (viewport, shares) = (truth.viewport, &ground_truth.shares());
    let own = |kind: &str| place.own(kind);
    let reference = Image::visibility(viewport, shares, &truth.status());
    let shown = Image::visibility(viewport, visibility, status);
    let error = judgement.errors(outputs, ground_truth);
    let uncertain = || Image::uncertain(visibility, status, truth);
    let mut images = Images {
        frame: place.frame,
        reference: draw(reference_name(place.view, viewport), reference)?,
        shaded: draw(own("shaded"), Image::shaded(visibility, truth))?,
        visibility: draw(own("visibility"), shown)?,
        error: draw(own("error"), error)?,
        uncertain: match counts.certain.lit + counts.certain.shadow + counts.uncertain {
            0 => None,
            _ => Some(draw(own("uncertain"), uncertain())?),
        },
        ..Images::default()
    };
    if let Some(footprints) = footprints {
        let mut heat = |kind: &str, part: fn(Footprint) -> f64| {
            let values: Vec<_> = footprints.iter().map(|pixel| pixel.map(part)).collect();
            draw(own(kind), Image::texels(&values, truth))
        };
        images.texels = Some(heat("texels", Footprint::texels)?);
        images.perspective = Some(heat("perspective", |footprint| footprint.perspective)?);
        images.projection = Some(heat("projection", |footprint| footprint.projection)?);
    }
    Ok((images, files))
}

/// Encodes the arrays of [`data::judged`]: visibility and status of each pixel, of a method's frame
/// and of the [reference](crate#terms). Returns the files to write.
///
/// # Errors
/// A file that cannot be encoded.
pub fn data_files(
    place: &PicturePlace,
    ground_truth: &GroundTruth,
    outputs: &Outputs,
    format: DataFormat,
) -> Result<Vec<PictureFile>> {
    let reference = reference_stem(place.view, ground_truth.pixels.viewport);
    let arrays = [place.stem.clone(), reference].into_iter();
    let arrays = arrays.zip(data::judged(outputs, ground_truth));
    let files = arrays.flat_map(|(stem, arrays)| {
        arrays.into_iter().map(move |(kind, array)| {
            let name = place.file(format!("{stem}-{kind}.{}", format.extension()));
            let bytes = array.encode(format);
            let bytes = bytes.map_err(|why| CompareError::Input(format!("{name} {why}")))?;
            Ok(PictureFile { name, bytes })
        })
    });
    files.collect()
}

/// Returns the name of the file for the frame with the index `frame`: `visibility.0003.png` for
/// `visibility.png` and 3.
pub fn numbered(file: &Path, frame: usize) -> PathBuf {
    let mut name = file.file_stem().unwrap_or_default().to_owned();
    name.push(format!(".{frame:04}"));
    if let Some(extension) = file.extension() {
        name.push(".");
        name.push(extension);
    }
    file.with_file_name(name)
}

/// Checks, before anything runs, that pictures do not overwrite each other. Each item is the
/// beginning of a picture's file name, and a name for its method and view in messages.
///
/// # Errors
/// Two items with the same beginning; the message has both names.
pub fn check_stems(stems: impl IntoIterator<Item = (String, String)>) -> Result<()> {
    let mut owners: BTreeMap<String, String> = BTreeMap::new();
    for (stem, owner) in stems {
        // Some file systems do not tell capitals from small letters.
        if let Some(other) = owners.get(&stem.to_lowercase()) {
            return Err(CompareError::Input(format!(
                "the pictures of {other} and of {owner} would overwrite each other: both are \
                 called {stem}-….png, or differ only in capitals\n  rename one, or run them one \
                 after the other into folders of their own"
            )));
        }
        owners.insert(stem.to_lowercase(), owner);
    }
    Ok(())
}

/// Returns view, viewport and map size of a run as text for progress: `main 512x512 map1024`. The
/// view's name is written as in file names.
pub fn conditions(method: &Method, view: &str, viewport: [u32; 2]) -> String {
    let map = method.map_size;
    let map = map.map_or(String::new(), |size| format!(" map{size}"));
    format!("{} {}{map}", slug(view), size(viewport))
}

/// Returns the beginning of the file names of a run's pictures: `nsm-main-512x512-map1024`, without
/// `-map1024` for a method without a map.
pub fn stem(method: &Method, view: &str, viewport: [u32; 2]) -> String {
    let conditions = conditions(method, view, viewport).replace(' ', "-");
    format!("{}-{conditions}", slug(&method.name))
}

/// Returns the beginning of the file names of the [reference](crate#terms)'s picture and arrays:
/// `reference-main-512x512`.
pub fn reference_stem(view: &str, viewport: [u32; 2]) -> String {
    format!("reference-{}-{}", slug(view), size(viewport))
}

/// Returns the file name of the chart of a method's graph: `graph-nsm.svg`.
pub fn graph_name(method: &str) -> String {
    format!("graph-{}.svg", slug(method))
}

/// Returns the file name of the [reference](crate#terms)'s picture of a still view:
/// `reference-main-512x512-visibility.png`.
pub fn reference_name(view: &str, viewport: [u32; 2]) -> String {
    format!("{}-visibility.png", reference_stem(view, viewport))
}

/// Returns a name as part of a file name: `my/method.ron` becomes `my-method`.
pub(crate) fn slug(name: &str) -> String {
    let stem = name.strip_suffix(".ron").unwrap_or(name);
    let plain = |c: char| c.is_alphanumeric() || matches!(c, '_' | '.');
    let dashed = |c: char| if plain(c) { c } else { '-' };
    let text: String = stem.chars().map(dashed).collect();
    text.trim_matches(['-', '.']).replace("--", "-")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slugs_are_file_names() {
        let slugs = ["nsm", "pipelines/nsm.ron", "/tmp/a b/../x.ron", "Größe 1"].map(slug);
        assert_eq!(slugs, ["nsm", "pipelines-nsm", "tmp-a-b-..-x", "Größe-1"]);
    }
}
