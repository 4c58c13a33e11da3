//! Colour textures, decoded when their texels are first read.

use crate::texels::Texels;
#[cfg(feature = "files")]
use crate::texture_file::{decode, read};
use std::sync::{Arc, OnceLock};

/// Treatment of a texture coordinate outside 0…1.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Wrap {
    /// The texture repeats.
    #[default]
    Repeat,
    /// The texture is mirrored at each edge.
    Mirror,
    /// The coordinate is clamped to 0…1: the outermost texels continue.
    Clamp,
}

impl Wrap {
    /// A coordinate brought into 0…1, in f64; what is not finite counts as 0.
    pub(crate) fn apply(self, at: f64) -> f64 {
        let at = if at.is_finite() { at } else { 0.0 };
        match self {
            Self::Repeat => at - at.floor(),
            Self::Mirror => {
                let in_two = at - 2.0 * (at * 0.5).floor();
                in_two.min(2.0 - in_two)
            }
            Self::Clamp => at.clamp(0.0, 1.0),
        }
    }

    /// The texel at a coordinate, of so many.
    pub(crate) fn texel(self, at: f64, size: u32) -> u32 {
        ((self.apply(at) * f64::from(size)) as u32).min(size - 1)
    }
}

/// Source of a texture's texels.
#[derive(Clone, Debug)]
pub enum Source {
    /// Decoded texels in memory.
    Texels(Arc<Texels>),
    /// Path of a PNG, JPEG or TGA file.
    #[cfg(feature = "files")]
    File(std::path::PathBuf),
    /// Bytes of an encoded PNG or JPEG, for example out of a `.glb` file.
    #[cfg(feature = "files")]
    Bytes(Arc<[u8]>),
}

/// Key that tells if two textures have the same source, without decoding them: equal keys mean the
/// same source.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub enum SourceKey {
    /// Address of the texels or bytes in memory.
    Memory(usize),
    /// Path of the file.
    #[cfg(feature = "files")]
    File(std::path::PathBuf),
}

impl Source {
    /// Returns the key of this source. A key of texels or bytes in memory is an address: it is
    /// valid as long as the source lives.
    pub fn key(&self) -> SourceKey {
        match self {
            Self::Texels(texels) => SourceKey::Memory(Arc::as_ptr(texels).addr()),
            #[cfg(feature = "files")]
            Self::File(path) => SourceKey::File(path.clone()),
            #[cfg(feature = "files")]
            Self::Bytes(bytes) => SourceKey::Memory(Arc::as_ptr(bytes).addr()),
        }
    }
}

/// Colour texture, whose texels are decoded at the first call of [`texels`](Self::texels).
#[derive(Clone, Debug)]
pub struct Texture {
    /// Name of the texture for error messages.
    pub name: String,
    /// Source of the texels.
    pub source: Source,
    /// Wrapping of the texture coordinates u and v outside 0…1, in this order.
    pub wrap: [Wrap; 2],
    texels: Arc<OnceLock<Result<Arc<Texels>, String>>>,
}

impl Texture {
    /// Creates a texture without reading its texels.
    pub fn new(name: String, source: Source, wrap: [Wrap; 2]) -> Self {
        let texels = Arc::default();
        Self {
            name,
            source,
            wrap,
            texels,
        }
    }

    /// Returns the texels. A PNG, JPEG or TGA is decoded at the first call; the result, or the
    /// error, is kept.
    ///
    /// # Errors
    /// Text that names the texture and says why it cannot be read.
    pub fn texels(&self) -> Result<&Texels, &str> {
        let decoded = self.texels.get_or_init(|| {
            let texels = match &self.source {
                Source::Texels(texels) => texels.checked(),
                #[cfg(feature = "files")]
                Source::File(path) => read(path).map(Arc::new),
                #[cfg(feature = "files")]
                Source::Bytes(bytes) => decode(bytes, None).map(Arc::new),
            };
            texels.map_err(|why| format!("{}: {why}", self.name))
        });
        decoded.as_deref().map_err(String::as_str)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texels_of_a_host_are_shared_and_counted() {
        let texels = |count| {
            Arc::new(Texels {
                size: [2, 3],
                rgba: vec![[7; 4]; count],
                has_alpha: false,
            })
        };
        let texture =
            |texels| Texture::new("brick".into(), Source::Texels(texels), [Wrap::Clamp; 2]);
        let (whole, again) = (texture(texels(6)), texture(texels(6)));
        assert_eq!(whole.texels().unwrap().rgba.len(), 6);
        assert_eq!(whole.source.key(), whole.clone().source.key());
        assert_ne!(whole.source.key(), again.source.key());
        let refused = texture(texels(5)).texels().unwrap_err().to_owned();
        assert_eq!(refused, "brick: 2 x 3 texels, of which 5 are given");
    }
}
