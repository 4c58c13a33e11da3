//! Decoded pictures, as the content of textures.

use std::sync::Arc;
use wgt::TextureFormat as F;

/// A decoded picture, the content of a texture that a document declares with `file: …`: RGBA texels
/// with 16 bits per channel.
#[derive(Clone, PartialEq, Eq)]
pub struct Picture {
    /// Width and height of the picture in texels.
    pub size: [u32; 2],
    /// Red, green, blue and alpha of each texel of the picture, row by row from the top, each row
    /// from the left; 65,535 means 1.0.
    pub texels: Arc<[[u16; 4]]>,
}

impl std::fmt::Debug for Picture {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Picture({}×{})", self.size[0], self.size[1])
    }
}

/// Type of a channel of a texel.
enum Channel {
    Byte,
    Half,
    Float,
}

/// Number and kind of the channels that a picture is put into.
fn channels(format: F) -> Option<(usize, Channel)> {
    Some(match format {
        F::R8Unorm => (1, Channel::Byte),
        F::Rg8Unorm => (2, Channel::Byte),
        F::Rgba8Unorm | F::Rgba8UnormSrgb => (4, Channel::Byte),
        F::R16Float => (1, Channel::Half),
        F::Rg16Float => (2, Channel::Half),
        F::Rgba16Float => (4, Channel::Half),
        F::R32Float => (1, Channel::Float),
        F::Rg32Float => (2, Channel::Float),
        F::Rgba32Float => (4, Channel::Float),
        _ => return None,
    })
}

/// True if a texture of this format can hold a picture.
pub(crate) fn can_hold(format: F) -> bool {
    channels(format).is_some()
}

impl Picture {
    /// Returns the texels as bytes of the texture format `format`: row by row from the top, without
    /// padding, numbers in little-endian order. Channels that the format lacks are left out. Values
    /// are converted linearly, for sRGB formats too; 65,535 becomes 1.0. `None` for formats other
    /// than R, Rg and Rgba with 8-bit unorm, 16-bit float or 32-bit float channels, and
    /// `Rgba8UnormSrgb`.
    pub fn bytes(&self, format: F) -> Option<Vec<u8>> {
        let (count, channel) = channels(format)?;
        let mut bytes = Vec::new();
        for texel in self.texels.iter() {
            for &value in &texel[..count] {
                let number = f32::from(value) / 65_535.0;
                match channel {
                    // 257 steps of sixteen bits are one of eight.
                    Channel::Byte => bytes.push(((u32::from(value) + 128) / 257) as u8),
                    Channel::Half => {
                        bytes.extend(half::f16::from_f32(number).to_le_bytes());
                    }
                    Channel::Float => bytes.extend(number.to_le_bytes()),
                }
            }
        }
        Some(bytes)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_of_eight_bits_are_what_they_were() {
        let texels = (0..=255u16)
            .map(|byte| [byte * 257, 0, 0, 65_535])
            .collect();
        let picture = Picture {
            size: [256, 1],
            texels,
        };
        let expected: Vec<u8> = (0..=255).collect();
        assert_eq!(picture.bytes(F::R8Unorm).unwrap(), expected);
        let floats = picture.bytes(F::Rgba32Float).unwrap();
        assert_eq!(floats[floats.len() - 4..], 1.0f32.to_le_bytes());
        assert_eq!(picture.bytes(F::R32Uint), None);
    }
}
