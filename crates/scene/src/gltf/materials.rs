//! Materials of a glTF file: base colour, mask, double-sidedness.

use super::buffers::{data_uri, path_of};
use crate::{
    mask::Mask,
    material::Material,
    texture::{Source, Texture, Wrap},
};
use glam::{Mat2, Vec2};
use gltf::{material::AlphaMode, texture::WrappingMode};
use std::{path::Path, sync::Arc};

/// A material, and which texture coordinates it takes.
pub(super) struct Read {
    pub material: Material,
    pub uv_set: u32,
    /// What is done to them: a matrix, then an offset.
    pub uv_transform: (Mat2, Vec2),
}

/// Reads a material.
///
/// # Errors
/// What is wrong with its mask.
pub(super) fn read(
    from: &gltf::Material<'_>,
    buffers: &[Arc<[u8]>],
    file: &Path,
) -> Result<Read, String> {
    let pbr = from.pbr_metallic_roughness();
    let [red, green, blue, alpha] = pbr.base_color_factor();
    let info = pbr.base_color_texture();
    let texture = match &info {
        Some(info) => Some(texture(&info.texture(), buffers, file)?),
        None => None,
    };
    let mut material = Material {
        name: from.name().unwrap_or("unnamed").to_owned(),
        base_color: [red, green, blue],
        texture,
        mask: None,
        double_sided: from.double_sided(),
    };
    if from.alpha_mode() == AlphaMode::Mask {
        let cutoff = from.alpha_cutoff().unwrap_or(0.5);
        let mask = mask(material.texture.as_ref(), alpha, cutoff)?;
        material.mask = (!mask.is_solid()).then(|| Arc::new(mask));
    }
    let transform = info.as_ref().and_then(|info| info.texture_transform());
    let uv_set = transform
        .as_ref()
        .and_then(|transform| transform.tex_coord());
    let uv_transform = transform.map_or((Mat2::IDENTITY, Vec2::ZERO), |transform| {
        let turn = Mat2::from_angle(-transform.rotation());
        let scale = Mat2::from_diagonal(transform.scale().into());
        (turn * scale, transform.offset().into())
    });
    Ok(Read {
        material,
        uv_set: uv_set.or(info.map(|info| info.tex_coord())).unwrap_or(0),
        uv_transform,
    })
}

fn mask(texture: Option<&Texture>, alpha: f32, cutoff: f32) -> Result<Mask, String> {
    let Some(texture) = texture else {
        return Ok(Mask::new([1, 1], [Wrap::Repeat; 2], |_, _| alpha >= cutoff));
    };
    let texels = texture.texels()?;
    let opacity = |texel: [u8; 4]| f32::from(texel[3]) / 255.0 * alpha;
    Ok(Mask::of_texels(texels, texture.wrap, opacity, cutoff))
}

fn texture(
    from: &gltf::Texture<'_>,
    buffers: &[Arc<[u8]>],
    file: &Path,
) -> Result<Texture, String> {
    let image = from.source();
    let place = format!("image {}", image.index());
    let (name, source) = match image.source() {
        gltf::image::Source::View { view, .. } => {
            let end = view.offset().checked_add(view.length());
            let bytes = buffers
                .get(view.buffer().index())
                .zip(end)
                .and_then(|(bytes, end)| bytes.get(view.offset()..end))
                .ok_or_else(|| format!("{place} reaches beyond its buffer"))?;
            (place, Source::Bytes(bytes.into()))
        }
        gltf::image::Source::Uri { uri, .. } => match data_uri(uri) {
            Some(bytes) => {
                let bytes = bytes.map_err(|why| format!("{place}: {why}"))?;
                (place, Source::Bytes(bytes.into()))
            }
            None => {
                let folder = file.parent().unwrap_or(Path::new(""));
                let path = folder.join(&*path_of(uri));
                (path.display().to_string(), Source::File(path))
            }
        },
    };
    let wrap = |mode| match mode {
        WrappingMode::ClampToEdge => Wrap::Clamp,
        WrappingMode::MirroredRepeat => Wrap::Mirror,
        WrappingMode::Repeat => Wrap::Repeat,
    };
    let sampler = from.sampler();
    let wrap = [wrap(sampler.wrap_s()), wrap(sampler.wrap_t())];
    Ok(Texture::new(name, source, wrap))
}
