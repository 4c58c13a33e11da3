//! The materials that the faces of an OBJ file use: colours, masks and their textures.

use super::guard::Guard;
use super::mtl_file::{self, MtlMaterial};
use super::options::{ObjMaterials, ObjOptions};
use super::texture_statement::{Channel, TextureStatement, UvTransform};
use crate::error::SceneError;
use crate::handed::is_file;
use crate::limit::Limit;
use crate::mask::Mask;
use crate::material::Material;
use crate::pattern::Pattern;
use crate::texels::Texels;
use crate::text::file_in;
use crate::texture::{Source, Texture, Wrap};
use std::collections::{BTreeMap, HashMap};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Room for hundreds of thousands of materials.
const MTL_FILE: Limit = Limit {
    of: "an .mtl file",
    mib: 64,
    way_out: "leave out what the mesh does not use",
};

/// Opacity from which on a surface is there: OBJ files say none.
const CUTOFF: f32 = 0.5;

/// The way out where a mask cannot be read.
const WAY_OUT: &str = "put it there, or give --materials color (every surface is opaque) or \
                       --materials ignore; a scene file says `materials: Color` or `Ignore`";

/// The way out where a line cannot be read.
const MEND: &str = "mend the line, or give --materials color (every surface is opaque); a scene \
                    file says `materials: Color`";

/// Materials that were found.
#[derive(Default)]
pub(super) struct Found {
    /// By the numbers that [`Guard::materials`] has them; none where the file names no file of
    /// them.
    pub materials: Vec<Material>,
    /// Map of the texture coordinates of each; none at all where they stay as they are.
    pub uvs: Vec<UvTransform>,
    /// Colours that could not be read.
    pub colours_missing: Vec<String>,
    /// Parts that were passed over.
    pub remarks: Vec<String>,
}

/// Reads the materials that the faces of an OBJ file use.
///
/// # Errors
/// [`SceneError::Part`] where a mask depends on what cannot be read.
pub(super) fn materials(
    guard: &Guard<'_>,
    options: &ObjOptions,
    path: &Path,
) -> Result<Found, SceneError> {
    if let ObjMaterials::Made(patterns) = &options.materials {
        let materials = made(guard, patterns, path)?;
        return Ok(Found {
            materials,
            ..Found::default()
        });
    }
    if guard.libraries.is_empty() {
        return Ok(Found::default());
    }
    let mut reading = Reading {
        path,
        with_masks: options.materials == ObjMaterials::All,
        found: Found::default(),
        masks: HashMap::new(),
    };
    let (by_name, unread) = reading.libraries(guard);
    let mut is_used = vec![false; guard.materials.len()];
    for face in &guard.faces {
        is_used[face.material as usize] = true;
    }
    // The first stands for none.
    let used = guard.materials.iter().zip(is_used).skip(1);
    let mut unknown = used.filter(|(name, is_used)| *is_used && !by_name.contains_key(*name));
    match unknown.next() {
        Some((name, _)) if unread.is_empty() => reading.found.remarks.push(format!(
            "material {name:?} is in no .mtl file that the file names: it is white and opaque"
        )),
        Some(_) => {
            for (place, reason) in unread {
                reading.fail(place, reason, WAY_OUT)?;
            }
        }
        None => {
            let passed = |(file, why): (String, String)| {
                format!("{file} passed over: {why}; no face uses a material of it")
            };
            reading.found.remarks.extend(unread.into_iter().map(passed));
        }
    }
    for name in &guard.materials {
        let (material, uvs) = match by_name.get(name) {
            Some((file, material)) => reading.material(file, material)?,
            None => (plain(name), UvTransform::IDENTITY),
        };
        reading.found.materials.push(material);
        reading.found.uvs.push(uvs);
    }
    Ok(reading.found)
}

fn plain(name: &str) -> Material {
    Material {
        name: name.to_owned(),
        ..Material::default()
    }
}

/// Materials that are known by name alone, some with a mask that is made here.
fn made(
    guard: &Guard<'_>,
    patterns: &BTreeMap<String, Pattern>,
    path: &Path,
) -> Result<Vec<Material>, SceneError> {
    if let Some(unknown) = patterns.keys().find(|name| !guard.materials.contains(name)) {
        return Err(SceneError::Part {
            path: path.to_owned(),
            place: format!("material {unknown:?}"),
            reason: "the scene file makes a mask for it, but no face uses it; leave it out of the \
                     scene file"
                .to_owned(),
        });
    }
    let masks: BTreeMap<&String, Arc<Mask>> = patterns
        .iter()
        .map(|(name, pattern)| (name, Arc::new(pattern.mask())))
        .collect();
    let materials = guard.materials.iter().map(|name| Material {
        name: name.clone(),
        mask: masks.get(name).cloned(),
        ..Material::default()
    });
    Ok(materials.collect())
}

struct Reading<'a> {
    path: &'a Path,
    with_masks: bool,
    found: Found,
    masks: HashMap<String, Arc<Mask>>,
}

/// Materials by name, with the files that they stand in.
type Known = HashMap<String, (PathBuf, MtlMaterial)>;

impl Reading<'_> {
    /// The materials of all files that `mtllib` lines name, and the files that cannot be read, with
    /// the reason.
    fn libraries(&self, guard: &Guard<'_>) -> (Known, Vec<(String, String)>) {
        let (mut by_name, mut unread) = (Known::new(), Vec::new());
        for file in guard
            .libraries
            .iter()
            .flat_map(|library| self.files(library))
        {
            match MTL_FILE.read(&file) {
                Ok(bytes) => {
                    let materials = mtl_file::parse(&bytes).into_iter();
                    by_name.extend(materials.map(|mtl| (mtl.name.clone(), (file.clone(), mtl))));
                }
                Err(why) => unread.push((file.display().to_string(), why.to_string())),
            }
        }
        (by_name, unread)
    }

    /// The files that a `mtllib` line names: one with spaces in its name, or several.
    fn files(&self, library: &str) -> Vec<PathBuf> {
        let whole = beside(self.path, library);
        if is_file(&whole) || !library.contains(char::is_whitespace) {
            return vec![whole];
        }
        let names = library.split_whitespace();
        names.map(|name| beside(self.path, name)).collect()
    }

    fn fail(
        &mut self,
        place: String,
        reason: String,
        way_out: &'static str,
    ) -> Result<(), SceneError> {
        if self.with_masks {
            return Err(SceneError::Part {
                path: self.path.to_owned(),
                place,
                reason: format!("{reason}; {way_out}"),
            });
        }
        self.found
            .colours_missing
            .push(format!("{place}: {reason}"));
        Ok(())
    }

    fn material(
        &mut self,
        file: &Path,
        from: &MtlMaterial,
    ) -> Result<(Material, UvTransform), SceneError> {
        let place = format!("material {:?} of {}", from.name, file.display());
        let remarks = from
            .remarks
            .iter()
            .map(|remark| format!("{place}: {remark}"));
        self.found.remarks.extend(remarks);
        let colour = from.diffuse_map.as_deref().map(TextureStatement::parse);
        let texture = colour.as_ref().map(|statement| {
            let source = beside(file, &statement.file);
            if !is_file(&source) {
                let missing = format!("{place}: {} is not there", source.display());
                self.found.colours_missing.push(missing);
            }
            let name = source.display().to_string();
            Texture::new(name, Source::File(source), [statement.wrap; 2])
        });
        let (mask, mask_uvs) = if self.with_masks {
            self.mask(file, &place, from)?
        } else {
            (None, None)
        };
        let colour_uvs = colour.map_or(UvTransform::IDENTITY, |statement| statement.uv);
        let uvs = mask_uvs.unwrap_or(colour_uvs);
        if texture.is_some() && uvs != colour_uvs {
            let text = "-o and -s of map_Kd are not followed, those of map_d are";
            self.found.remarks.push(format!("{place}: {text}"));
        }
        let material = Material {
            name: from.name.clone(),
            // As with a texture of other tools, which multiply both.
            base_color: from.diffuse.unwrap_or([1.0; 3]),
            texture,
            mask,
            ..Material::default()
        };
        Ok((material, uvs))
    }

    /// The mask of a material, and what becomes of its texture coordinates if it has a texture.
    fn mask(
        &mut self,
        file: &Path,
        place: &str,
        from: &MtlMaterial,
    ) -> Result<(Option<Arc<Mask>>, Option<UvTransform>), SceneError> {
        if let Some(fault) = &from.fault {
            self.fail(place.to_owned(), fault.clone(), MEND)?;
        }
        let opacity = from.opacity();
        let Some(text) = &from.dissolve_map else {
            let hidden = || Arc::new(Mask::new([1, 1], [Wrap::Repeat; 2], |_, _| false));
            let is_hidden = opacity < CUTOFF;
            if is_hidden && from.dissolve.is_none() {
                let text = "Tr hides it, whose opacity is 1 - Tr; write d if that is not meant";
                self.found.remarks.push(format!("{place}: {text}"));
            }
            return Ok((is_hidden.then(hidden), None));
        };
        let statement = TextureStatement::parse(text);
        for option in &statement.passed_over {
            let text = format!("{option} of map_d is not followed");
            self.found.remarks.push(format!("{place}: {text}"));
        }
        let (uvs, wrap) = (statement.uv, statement.wrap);
        let source = beside(file, &statement.file);
        let (channel, [base, gain]) = (statement.channel, statement.range);
        let key = format!(
            "{opacity} {wrap:?} {channel:?} {base} {gain} {}",
            source.display()
        );
        let mask = match self.masks.get(&key) {
            Some(mask) => mask.clone(),
            None => {
                let name = format!("map_d {}", source.display());
                let texture = Texture::new(name, Source::File(source), [wrap; 2]);
                let texels = match texture.texels() {
                    Ok(texels) => texels,
                    Err(why) => {
                        self.fail(place.to_owned(), why.to_owned(), WAY_OUT)?;
                        return Ok((None, None));
                    }
                };
                let own = opacity_channel(texels);
                let at = |texel| (base + gain * level(channel, own, texel)) * opacity;
                let mask = Arc::new(Mask::from_texels(texels, [wrap; 2], at, CUTOFF));
                self.masks.insert(key, mask.clone());
                mask
            }
        };
        Ok(((!mask.is_solid()).then_some(mask), Some(uvs)))
    }
}

/// The number of a texel that counts, from 0 to 1.
fn level(channel: Channel, own: usize, texel: [u8; 4]) -> f32 {
    let fraction = |channel: usize| f32::from(texel[channel]) / 255.0;
    match channel {
        Channel::Own => fraction(own),
        Channel::Of(channel) => fraction(channel),
        Channel::Luminance => (fraction(0) + fraction(1) + fraction(2)) / 3.0,
    }
}

/// Alpha where a texture has any, red of a grey one.
fn opacity_channel(texels: &Texels) -> usize {
    if texels.has_alpha && texels.rgba.iter().any(|texel| texel[3] < 255) {
        3
    } else {
        0
    }
}

/// A file that another one names. Some tools write paths with backslashes.
fn beside(file: &Path, name: &str) -> PathBuf {
    file_in(
        file.parent().unwrap_or(Path::new("")),
        &name.replace('\\', "/"),
    )
}
