//! The pictures of a run and of the reference, and their file names.

use crate::error::CliError;
use crate::graphs::contract::{Judgement, Outputs};
use crate::graphs::method::Method;
use crate::pictures::png;
use crate::records::results::Images;
use crate::wording::size;
use skiagraph_reference::{Error, Image, RightAnswer};
use std::{collections::BTreeMap, path::Path};

/// Writes the pictures of a frame, their names beginning with `stem`.
///
/// # Errors
/// One cannot be written.
pub fn save_pictures(
    folder: &Path,
    stem: &str,
    right: &RightAnswer,
    outputs: &Outputs,
    judgement: &Judgement,
) -> Result<Images, CliError> {
    let Judgement { counts, graded } = judgement;
    let (reference, visibility, status) = (&right.reference, &outputs.shown(), &outputs.status);
    let save = |kind: &str, image| save_picture(folder, format!("{stem}-{kind}.png"), image);
    Ok(Images {
        shaded: save("shaded", Image::shaded(visibility, reference))?,
        visibility: save(
            "visibility",
            Image::visibility(reference.viewport, visibility, status),
        )?,
        error: match graded {
            None => save(
                "error",
                Image::error(&outputs.visibility, status, reference),
            )?,
            Some(_) => {
                let difference = Image::difference(visibility, &right.shares(), reference);
                save("error", difference)?
            }
        },
        uncertain: match counts.certain.lit + counts.certain.shadow + counts.uncertain {
            0 => None,
            _ => {
                let image = Image::uncertain(visibility, status, reference);
                Some(save("uncertain", image)?)
            }
        },
    })
}

/// Writes the picture of the reference of a view or case.
///
/// # Errors
/// It cannot be written.
pub fn save_reference(folder: &Path, view: &str, right: &RightAnswer) -> Result<(), CliError> {
    let reference = &right.reference;
    let image = Image::visibility(reference.viewport, &right.shares(), &reference.status());
    save_picture(folder, reference_name(view, reference.viewport), image).map(|_| ())
}

fn save_picture(
    folder: &Path,
    name: String,
    image: Result<Image, Error>,
) -> Result<String, CliError> {
    let image = image.map_err(|error| CliError::Input(format!("no picture {name}: {error}")))?;
    png::save(&folder.join(&name), &image)?;
    Ok(name)
}

/// Refuses pictures that would overwrite each other, before anything runs: what the name of each
/// begins with, and whose they are.
///
/// # Errors
/// Names both owners; `option` is what says where pictures go.
pub fn check_stems(
    stems: impl IntoIterator<Item = (String, String)>,
    option: &str,
) -> Result<(), CliError> {
    let mut owners: BTreeMap<String, String> = BTreeMap::new();
    for (stem, owner) in stems {
        if let Some(other) = owners.get(&stem) {
            return Err(CliError::Input(format!(
                "the pictures of {other} and of {owner} would overwrite each other: both are \
                 called {stem}-….png\n  rename one, or run them one after the other with another \
                 {option}"
            )));
        }
        owners.insert(stem, owner);
    }
    Ok(())
}

/// View, viewport and map size of a run, as progress lines have them.
pub fn conditions(method: &Method, view: &str, viewport: [u32; 2]) -> String {
    let map = method
        .map_size
        .map_or(String::new(), |size| format!(" map{size}"));
    format!("{} {}{map}", slug(view), size(viewport))
}

/// What the names of a run's pictures begin with.
pub fn stem(method: &Method, view: &str, viewport: [u32; 2]) -> String {
    format!(
        "{}-{}",
        slug(&method.name),
        conditions(method, view, viewport).replace(' ', "-")
    )
}

/// What the name of the reference's picture begins with.
pub fn reference_stem(view: &str, viewport: [u32; 2]) -> String {
    format!("reference-{}-{}", slug(view), size(viewport))
}

/// The name of the chart of a method's graph.
pub fn graph_name(method: &str) -> String {
    format!("graph-{}.svg", slug(method))
}

/// The name of the reference's picture.
pub fn reference_name(view: &str, viewport: [u32; 2]) -> String {
    format!("{}-visibility.png", reference_stem(view, viewport))
}

/// A name as part of a file name: `my/method.ron` becomes `my-method`.
fn slug(name: &str) -> String {
    let stem = name.strip_suffix(".ron").unwrap_or(name);
    let plain = |c: char| c.is_alphanumeric() || matches!(c, '_' | '.');
    let text: String = stem
        .chars()
        .map(|c| if plain(c) { c } else { '-' })
        .collect();
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
