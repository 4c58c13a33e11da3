//! The materials that an OBJ file names: files of materials, read by `tobj`, and their textures.

use super::{
    guard::Guard,
    options::{ObjMaterials, ObjOptions},
};
use crate::{
    error::SceneError,
    limit::Limit,
    mask::Mask,
    material::Material,
    pattern::Pattern,
    texels::Texels,
    texture::{Source, Texture, Wrap},
};
use std::{
    collections::{BTreeMap, HashMap},
    io::{self, BufRead, Read},
    path::{Path, PathBuf},
    sync::Arc,
};

/// Room for hundreds of thousands of materials.
const MTL_FILE: Limit = Limit {
    of: "an .mtl file",
    mib: 64,
    way_out: "leave out what the mesh does not use",
};

/// Opacity from which on a surface is there: OBJ files say none.
const CUTOFF: f32 = 0.5;

const WAY_OUT: &str = "put it there, or have a scene file say `materials: Ignore`";

/// Materials by the numbers that [`Guard::materials`] has them, and what is missing of colours.
pub(super) type Found = (Vec<Material>, Vec<String>);

/// Reads the materials that the faces of an OBJ file use. None where it names no file of them.
///
/// # Errors
/// [`SceneError::Material`] where a mask depends on what cannot be read.
pub(super) fn materials(
    guard: &Guard<'_>,
    options: &ObjOptions,
    path: &Path,
) -> Result<Found, SceneError> {
    if let ObjMaterials::Made(patterns) = &options.materials {
        return made(guard, patterns, path).map(|materials| (materials, Vec::new()));
    }
    let mut reading = Reading {
        path,
        with_masks: options.materials == ObjMaterials::All,
        missing: Vec::new(),
        masks: HashMap::new(),
    };
    if guard.libraries.is_empty() {
        return Ok((Vec::new(), Vec::new()));
    }
    let mut known: HashMap<String, (PathBuf, tobj::Material)> = HashMap::new();
    for library in &guard.libraries {
        for file in reading.files(library) {
            match load(&file) {
                Ok(found) => known.extend(
                    found
                        .into_iter()
                        .map(|material| (material.name.clone(), (file.clone(), material))),
                ),
                Err(reason) => reading.fail(file.display().to_string(), reason)?,
            }
        }
    }
    let mut materials = Vec::with_capacity(guard.materials.len());
    for name in &guard.materials {
        materials.push(match known.get(name) {
            Some((file, material)) => reading.material(file, material)?,
            None => Material {
                name: name.clone(),
                ..Material::default()
            },
        });
    }
    Ok((materials, reading.missing))
}

/// Materials that are known by name alone, some with a mask that is made here.
fn made(
    guard: &Guard<'_>,
    patterns: &BTreeMap<String, Pattern>,
    path: &Path,
) -> Result<Vec<Material>, SceneError> {
    if let Some(unknown) = patterns.keys().find(|name| !guard.materials.contains(name)) {
        return Err(SceneError::Material {
            path: path.to_owned(),
            place: format!("material {unknown:?}"),
            reason: "the scene file makes a mask for it, but no face uses it".to_owned(),
            way_out: "leave it out of the scene file",
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
    missing: Vec<String>,
    masks: HashMap<String, Arc<Mask>>,
}

impl Reading<'_> {
    /// The files that a `mtllib` line names: one with spaces in its name, or several.
    fn files(&self, library: &str) -> Vec<PathBuf> {
        let whole = beside(self.path, library);
        if whole.is_file() || !library.contains(char::is_whitespace) {
            return vec![whole];
        }
        let names = library.split_whitespace();
        names.map(|name| beside(self.path, name)).collect()
    }

    fn fail(&mut self, place: String, reason: String) -> Result<(), SceneError> {
        if self.with_masks {
            let path = self.path.to_owned();
            return Err(SceneError::Material {
                path,
                place,
                reason,
                way_out: WAY_OUT,
            });
        }
        self.missing.push(format!("{place}: {reason}"));
        Ok(())
    }

    fn material(&mut self, file: &Path, from: &tobj::Material) -> Result<Material, SceneError> {
        let place = format!("material {:?} of {}", from.name, file.display());
        let texture = from.diffuse_texture.as_ref().map(|text| {
            let (name, wrap) = texture_name(text);
            let source = beside(file, &name);
            if !source.is_file() {
                self.missing
                    .push(format!("{place}: {} is not there", source.display()));
            }
            let name = source.display().to_string();
            Texture::new(name, Source::File(source), [wrap; 2])
        });
        let mask = match self.with_masks {
            true => self.mask(file, place, from)?,
            false => None,
        };
        Ok(Material {
            name: from.name.clone(),
            // As with a texture of other tools, which multiply both.
            base_color: from.diffuse.unwrap_or([1.0; 3]),
            texture,
            mask,
            double_sided: false,
        })
    }

    fn mask(
        &mut self,
        file: &Path,
        place: String,
        from: &tobj::Material,
    ) -> Result<Option<Arc<Mask>>, SceneError> {
        let opacity = from.dissolve.unwrap_or(1.0);
        let Some(text) = &from.dissolve_texture else {
            let hidden = || Arc::new(Mask::new([1, 1], [Wrap::Repeat; 2], |_, _| false));
            return Ok((opacity < CUTOFF).then(hidden));
        };
        let (name, wrap) = texture_name(text);
        let source = beside(file, &name);
        let key = format!("{opacity} {wrap:?} {}", source.display());
        if let Some(mask) = self.masks.get(&key) {
            return Ok((!mask.is_solid()).then(|| mask.clone()));
        }
        let name = format!("map_d {}", source.display());
        let texture = Texture::new(name, Source::File(source), [wrap; 2]);
        let texels = match texture.texels() {
            Ok(texels) => texels,
            Err(why) => {
                self.fail(place, why.to_owned())?;
                return Ok(None);
            }
        };
        let channel = opacity_channel(texels);
        let at = |texel: [u8; 4]| f32::from(texel[channel]) / 255.0 * opacity;
        let mask = Arc::new(Mask::of_texels(texels, texture.wrap, at, CUTOFF));
        self.masks.insert(key, mask.clone());
        Ok((!mask.is_solid()).then_some(mask))
    }
}

/// Alpha where a texture has any, red of a grey one.
fn opacity_channel(texels: &Texels) -> usize {
    match texels.has_alpha && texels.rgba.iter().any(|texel| texel[3] < 255) {
        true => 3,
        false => 0,
    }
}

/// A file that another one names. Some tools write paths with backslashes.
fn beside(file: &Path, name: &str) -> PathBuf {
    let folder = file.parent().unwrap_or(Path::new(""));
    folder.join(name.replace('\\', "/"))
}

/// The file in a texture statement, whose options stand in front of it.
fn texture_name(text: &str) -> (String, Wrap) {
    let mut wrap = Wrap::Repeat;
    let mut rest = text.trim();
    while let Some(option) = rest
        .split_whitespace()
        .next()
        .filter(|word| is_option(word))
    {
        rest = rest[option.len()..].trim_start();
        while let Some(word) = rest.split_whitespace().next() {
            let is_value = match option {
                "-clamp" | "-blendu" | "-blendv" | "-cc" => matches!(word, "on" | "off"),
                "-imfchan" => matches!(word, "r" | "g" | "b" | "m" | "l" | "z"),
                "-type" => !word.contains('.'),
                _ => word.parse::<f32>().is_ok(),
            };
            if !is_value {
                break;
            }
            if option == "-clamp" && word == "on" {
                wrap = Wrap::Clamp;
            }
            rest = rest[word.len()..].trim_start();
        }
    }
    (rest.to_owned(), wrap)
}

fn is_option(word: &str) -> bool {
    const OPTIONS: [&str; 12] = [
        "-clamp", "-blendu", "-blendv", "-cc", "-imfchan", "-type", "-mm", "-o", "-s", "-t", "-bm",
        "-texres",
    ];
    OPTIONS.contains(&word)
}

/// The materials of a file.
fn load(path: &Path) -> Result<Vec<tobj::Material>, String> {
    let bytes = MTL_FILE.read(path).map_err(|why| why.to_string())?;
    let mut lines = Lines {
        rest: bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(&bytes),
        begun: false,
        number: 0,
    };
    let loaded = tobj::load_mtl_buf(&mut lines);
    loaded
        .map(|(materials, _)| materials)
        .map_err(|why| format!("line {}: {why}", lines.number))
}

/// Counts the lines that `tobj` reads, which tells none.
struct Lines<'a> {
    rest: &'a [u8],
    begun: bool,
    number: u32,
}

impl Read for Lines<'_> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let read = self.fill_buf()?.read(buffer)?;
        self.consume(read);
        Ok(read)
    }
}

impl BufRead for Lines<'_> {
    fn fill_buf(&mut self) -> io::Result<&[u8]> {
        if !self.begun && !self.rest.is_empty() {
            (self.begun, self.number) = (true, self.number.saturating_add(1));
        }
        let end = self.rest.iter().position(|&byte| byte == b'\n');
        Ok(&self.rest[..end.map_or(self.rest.len(), |end| end + 1)])
    }

    fn consume(&mut self, amount: usize) {
        let (taken, rest) = self.rest.split_at(amount.min(self.rest.len()));
        self.begun &= taken.last() != Some(&b'\n');
        self.rest = rest;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn options_stand_in_front_of_a_textures_name() {
        let name = |text| texture_name(text).0;
        assert_eq!(name("leaf.png"), "leaf.png");
        assert_eq!(name("-s 1 1 1 -o 0.5 my leaf.png"), "my leaf.png");
        assert_eq!(name("-bm 0.2 -imfchan l 2 leaves.tga"), "2 leaves.tga");
        assert_eq!(name("-clamp on on.png"), "on.png");
        assert_eq!(texture_name("-clamp on on.png").1, Wrap::Clamp);
        assert_eq!(name("-leaf.png"), "-leaf.png");
    }
}
