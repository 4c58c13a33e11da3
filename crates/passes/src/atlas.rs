//! Materials and the texels of their base colours as shaders read them.

use crate::error::Error;
use skiagraph_scene::{Surfaces, texture::SourceKey};
use std::collections::HashMap;

/// One material of the mesh as shaders read it: an item of the buffer `scene.materials`, 32 bytes.
/// The items stand in the order of [`Surfaces::materials`].
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct MaterialRecord {
    /// Base colour: linear red, green and blue. Shaders multiply it by the texture.
    pub base_color: [f32; 3],
    /// Index in the buffer `scene.texels` of the texture's first texel, at the top left; the rest
    /// of the texture follows row by row. 0 if the material has no texture.
    pub first_texel: u32,
    /// Width and height of the texture in texels; both 0 if the material has no texture.
    pub size: [u32; 2],
    /// Wrapping beyond the texture's edges, in u and in v: 0 repeats, 1 mirrors, 2 clamps.
    pub wrap: [u32; 2],
}

/// All textures in one buffer.
#[derive(Clone, Default)]
pub(crate) struct Atlas {
    pub records: Vec<MaterialRecord>,
    pub texels: Vec<u32>,
    /// First texel of each texture.
    places: HashMap<SourceKey, u32>,
}

impl Atlas {
    /// Packs those materials of a mesh that came behind the packed ones, and reads each texture
    /// once.
    ///
    /// # Errors
    /// [`Error::Texture`] for a texture that cannot be read.
    pub fn append(&mut self, surfaces: &Surfaces) -> Result<(), Error> {
        for material in &surfaces.materials[self.records.len()..] {
            let mut record = MaterialRecord {
                base_color: material.base_color,
                ..MaterialRecord::default()
            };
            if let Some(texture) = &material.texture {
                let read = texture.texels();
                let texels = read.map_err(|why| Error::Texture(why.to_owned()))?;
                let key = texture.source.key();
                record.first_texel = *self.places.entry(key).or_insert_with(|| {
                    let first = self.texels.len() as u32;
                    let words = texels.rgba.iter().copied().map(u32::from_le_bytes);
                    self.texels.extend(words);
                    first
                });
                record.size = texels.size;
                record.wrap = texture.wrap.map(|wrap| wrap as u32);
            }
            self.records.push(record);
        }
        Ok(())
    }
}
