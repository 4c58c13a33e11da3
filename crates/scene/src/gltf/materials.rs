//! Materials of a glTF file: base colour, mask, double-sidedness.

use super::beside::Beside;
use super::buffers::{Buffers, data_uri, path_of};
use crate::handed::is_file;
use crate::mask::Mask;
use crate::material::Material;
use crate::material_use::MaterialUse;
use crate::texture::{Source, Texture, Wrap};
use crate::texture_file::check_format;
use glam::{Mat2, Vec2};
use gltf::{material::AlphaMode, texture::WrappingMode};
use std::{path::Path, sync::Arc};

/// The way out where a mask or a texture cannot be read.
const WAY_OUT: &str = "mend it, or give --materials color (every surface is opaque) or \
                       --materials ignore; a scene file says `materials: Color` or `Ignore`";

/// The one extension that a file may not be without, where a surface shows it: what Basis packs
/// cannot be left to chance.
const BASIS: &str = "KHR_texture_basisu";

/// A material, and which texture coordinates it takes; without more said, that of surfaces that
/// have none.
#[derive(Clone, Default)]
pub(super) struct Read {
    pub material: Material,
    pub uv_set: u32,
    /// Transform of texture coordinates: a matrix, then an offset.
    pub uv_transform: (Mat2, Vec2),
    /// Where it is masked.
    pub cut: Option<Cut>,
}

/// How a masked material is cut out: where alpha, times that of the texture, is the cutoff at
/// least.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Cut {
    pub alpha: f32,
    pub cutoff: f32,
}

impl Read {
    /// The mask of the material. The alpha of each texel is multiplied by those of `cut` and of a
    /// vertex, `alpha`, and is opaque from the cutoff on. `None` if all texels are opaque.
    ///
    /// # Errors
    /// The texture cannot be read.
    pub fn masked(&self, cut: Cut, alpha: f32) -> Result<Option<Arc<Mask>>, String> {
        let (alpha, cutoff) = (cut.alpha * alpha, cut.cutoff);
        let mask = match &self.material.texture {
            Some(texture) => {
                let opacity = |texel: [u8; 4]| f32::from(texel[3]) / 255.0 * alpha;
                Mask::from_texels(texture.texels()?, texture.wrap, opacity, cutoff)
            }
            None => Mask::new([1, 1], [Wrap::Repeat; 2], |_, _| alpha >= cutoff),
        };
        Ok((!mask.is_solid()).then(|| Arc::new(mask)))
    }
}

/// Where materials are read from.
pub(super) struct Reader<'a> {
    pub buffers: &'a Buffers,
    pub beside: &'a Beside,
    pub file: &'a Path,
    pub of: MaterialUse,
    /// Colours that could not be read.
    pub colours_missing: Vec<String>,
    /// Number of materials that are blended over what is behind them.
    pub blended: usize,
}

impl Reader<'_> {
    /// Reads a material; `place` is what it is called in messages.
    ///
    /// # Errors
    /// The fault of its mask.
    pub fn read(&mut self, from: &gltf::Material<'_>, place: &str) -> Result<Read, String> {
        let pbr = from.pbr_metallic_roughness();
        let [red, green, blue, alpha] = pbr.base_color_factor();
        let info = pbr.base_color_texture();
        let with_masks = matches!(self.of, MaterialUse::All | MaterialUse::BlendMask);
        let is_blended = with_masks && from.alpha_mode() == AlphaMode::Blend;
        let is_blend_mask = is_blended && self.of == MaterialUse::BlendMask;
        self.blended += usize::from(is_blended && !is_blend_mask);
        let is_masked = is_blend_mask || (with_masks && from.alpha_mode() == AlphaMode::Mask);
        let texture = match &info {
            Some(info) => match self.texture(&info.texture()) {
                Ok(texture) => Some(texture),
                Err(why) if is_masked || (with_masks && why.contains(BASIS)) => {
                    return Err(format!("{why}; {WAY_OUT}"));
                }
                Err(why) => {
                    self.colours_missing.push(format!("{place}: {why}"));
                    None
                }
            },
            None => None,
        };
        let transform = info.as_ref().and_then(|info| info.texture_transform());
        let uv_set = transform.as_ref().and_then(|it| it.tex_coord());
        let uv_transform = transform.map_or((Mat2::IDENTITY, Vec2::ZERO), |transform| {
            let turn = Mat2::from_angle(-transform.rotation());
            let scale = Mat2::from_diagonal(transform.scale().into());
            (turn * scale, transform.offset().into())
        });
        let mut read = Read {
            material: Material {
                name: from.name().unwrap_or("unnamed").to_owned(),
                base_color: [red, green, blue],
                texture,
                double_sided: from.double_sided(),
                ..Material::default()
            },
            uv_set: uv_set.or(info.map(|info| info.tex_coord())).unwrap_or(0),
            uv_transform,
            cut: None,
        };
        if is_masked {
            let cutoff = from.alpha_cutoff().filter(|_| !is_blended).unwrap_or(0.5);
            let cut = Cut { alpha, cutoff };
            let mask = read.masked(cut, 1.0);
            read.material.mask = mask.map_err(|why| format!("{why}; {WAY_OUT}"))?;
            read.cut = Some(cut);
        }
        Ok(read)
    }

    /// # Errors
    /// Why its picture cannot be read.
    fn texture(&self, from: &gltf::Texture<'_>) -> Result<Texture, String> {
        let number = from.index();
        if let Some(why) = self.beside.unread.get(&number) {
            return Err(format!("texture {number}: {why}"));
        }
        let image = from.source();
        let place = format!("image {}", image.index());
        let (name, source) = match image.source() {
            gltf::image::Source::View { view, .. } => {
                let bytes = self.buffers.view(&view);
                let bytes = bytes.ok_or_else(|| format!("{place} reaches beyond its buffer"))?;
                (place, Source::Bytes(bytes.into()))
            }
            gltf::image::Source::Uri { uri: "", .. } => {
                return Err(format!(
                    "{place}: it has neither a uri nor a bufferView with its mimeType"
                ));
            }
            gltf::image::Source::Uri { uri, .. } => match data_uri(uri) {
                Some(bytes) => {
                    let bytes = bytes.map_err(|why| format!("{place}: {why}"))?;
                    (place, Source::Bytes(bytes.into()))
                }
                None => {
                    let folder = self.file.parent().unwrap_or(Path::new(""));
                    let path = path_of(folder, uri);
                    if !is_file(&path) {
                        return Err(format!("{place}: {} is not there", path.display()));
                    }
                    (path.display().to_string(), Source::File(path))
                }
            },
        };
        if let Source::Bytes(bytes) = &source {
            check_format(bytes).map_err(|why| format!("{name}: {why}"))?;
        }
        let wrap = |mode| match mode {
            WrappingMode::ClampToEdge => Wrap::Clamp,
            WrappingMode::MirroredRepeat => Wrap::Mirror,
            WrappingMode::Repeat => Wrap::Repeat,
        };
        let sampler = from.sampler();
        let wrap = [wrap(sampler.wrap_s()), wrap(sampler.wrap_t())];
        Ok(Texture::new(name, source, wrap))
    }
}
