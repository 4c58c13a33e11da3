//! Colour textures, decoded when their texels are first looked at.

use crate::texels::Texels;
#[cfg(feature = "files")]
use crate::texture_file::{decode, read};
use std::sync::{Arc, OnceLock};

/// Wrapping of a texture beyond its edges.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Wrap {
    /// It begins anew.
    #[default]
    Repeat,
    /// It is mirrored.
    Mirror,
    /// Its outermost texels go on.
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

/// Where the texels of a texture are.
#[derive(Clone, Debug)]
pub enum Source {
    /// The host has them.
    Texels(Arc<Texels>),
    /// A file.
    #[cfg(feature = "files")]
    File(std::path::PathBuf),
    /// The content of a file, as a `.glb` holds it.
    #[cfg(feature = "files")]
    Bytes(Arc<[u8]>),
}

/// Tells texels apart without a look at them: equal where two textures have the same source.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub enum SourceKey {
    /// An address.
    Memory(usize),
    /// A file.
    #[cfg(feature = "files")]
    File(std::path::PathBuf),
}

impl Source {
    /// Which source it is, as long as it lives.
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

/// A colour texture.
#[derive(Clone, Debug)]
pub struct Texture {
    /// Its name in messages.
    pub name: String,
    /// Where it is.
    pub source: Source,
    /// Wrapping beyond its edges, for u and v.
    pub wrap: [Wrap; 2],
    texels: Arc<OnceLock<Result<Arc<Texels>, String>>>,
}

impl Texture {
    /// A texture that is not read yet.
    pub fn new(name: String, source: Source, wrap: [Wrap; 2]) -> Self {
        let texels = Arc::default();
        Self {
            name,
            source,
            wrap,
            texels,
        }
    }

    /// Its texels; those of a PNG, JPEG or TGA are decoded when first asked for.
    ///
    /// # Errors
    /// Which texture cannot be read, and why.
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
