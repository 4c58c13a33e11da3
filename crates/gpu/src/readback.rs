//! Contents of outputs and captures that were read back from the GPU.

/// Content of an output or capture, read back to the host: an entry of
/// [`FrameReport::readbacks`](crate::FrameReport::readbacks).
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Readback {
    /// Name of the output or capture, as in [`Frame::read`](crate::Frame::read).
    pub name: String,
    /// Texels or bytes of the output or capture.
    pub content: Content,
}

/// Bytes of a texture or buffer, or of the part that belongs to the output, that was read back.
#[derive(Clone, Debug, PartialEq)]
pub enum Content {
    /// The mips and layers of a texture that belong to the output.
    Texture {
        /// Format of the texels in `bytes`, one of the formats of wgpu.
        format: wgpu::TextureFormat,
        /// Width and height in texels of each part. A part is one mip of one layer (or slice). All
        /// layers of the first mip come first, then all layers of the second mip, and so on.
        parts: Vec<[u32; 2]>,
        /// Texels of all parts in the layout of `format`, one part behind the other in the order of
        /// `parts`: rows from the top, without padding.
        bytes: Vec<u8>,
    },
    /// Bytes of a buffer, or of its items that belong to the output.
    Buffer(Vec<u8>),
}

impl Content {
    /// Returns width and height of the first part of a texture in texels; `None` for a buffer.
    pub fn size(&self) -> Option<[u32; 2]> {
        match self {
            Self::Texture { parts, .. } => parts.first().copied(),
            Self::Buffer(_) => None,
        }
    }

    /// Splits a texture into one content for each mip of each layer, in the order of its `parts`. A
    /// buffer comes back whole, as the only element.
    pub fn split(&self) -> Vec<Self> {
        let Self::Texture {
            format,
            parts,
            bytes,
        } = self
        else {
            return vec![self.clone()];
        };
        let texel = format.block_copy_size(None).unwrap_or(4) as usize;
        let mut rest = &bytes[..];
        let part = |&[width, height]: &[u32; 2]| {
            let length = (width as usize * height as usize * texel).min(rest.len());
            let (part, behind) = rest.split_at(length);
            rest = behind;
            Self::Texture {
                format: *format,
                parts: vec![[width, height]],
                bytes: part.to_vec(),
            }
        };
        parts.iter().map(part).collect()
    }

    /// Returns the raw bytes of the buffer, or of all parts of the texture in the order of `parts`:
    /// rows from the top, without padding.
    pub fn bytes(&self) -> &[u8] {
        match self {
            Self::Texture { bytes, .. } | Self::Buffer(bytes) => bytes,
        }
    }

    /// Returns the channels of a `Uint` or `Stencil8` texture, texel after texel, or the
    /// little-endian 32-bit words of a buffer (up to 3 bytes behind the last whole word are left
    /// out). `None` for a texture of any other format, packed formats included.
    pub fn as_u32(&self) -> Option<Vec<u32>> {
        match self {
            Self::Buffer(bytes) => Some(bytes.chunks_exact(4).map(unsigned).collect()),
            Self::Texture { .. } => self.channels(Kind::Uint, unsigned),
        }
    }

    /// Returns the channels of a `Sint` texture, texel after texel. `None` for a buffer and for a
    /// texture of any other format.
    pub fn as_i32(&self) -> Option<Vec<i32>> {
        self.channels(Kind::Sint, signed)
    }

    /// Returns the channels of a texture of floats, depths or normalised integers, texel after
    /// texel, in the order red, green, blue, alpha. Values of an sRGB texture are returned as
    /// stored, not linear. `None` for a buffer, and for a texture of an integer, packed or
    /// compressed format.
    pub fn as_f32(&self) -> Option<Vec<f32>> {
        let float = |bytes: &[u8]| match *bytes {
            [a, b] => half::f16::from_le_bytes([a, b]).to_f32(),
            _ => f32::from_bits(unsigned(bytes)),
        };
        let greatest =
            |bytes: &[u8], sign: u32| ((1u64 << (8 * bytes.len() as u32 - sign)) - 1) as f32;
        let unorm = |bytes: &[u8]| unsigned(bytes) as f32 / greatest(bytes, 0);
        // The least integer is the same as the one above it: -1.
        let snorm = |bytes: &[u8]| (signed(bytes) as f32 / greatest(bytes, 1)).max(-1.0);
        let mut values = self
            .channels(Kind::Float, float)
            .or_else(|| self.channels(Kind::Unorm, unorm))
            .or_else(|| self.channels(Kind::Snorm, snorm))?;
        if let Self::Texture {
            format: wgpu::TextureFormat::Bgra8Unorm | wgpu::TextureFormat::Bgra8UnormSrgb,
            ..
        } = self
        {
            let texels = values.chunks_exact_mut(4);
            texels.for_each(|texel| texel.swap(0, 2));
        }
        Some(values)
    }

    /// The channels of a texture whose format is of this kind.
    fn channels<T>(&self, kind: Kind, decode: impl Fn(&[u8]) -> T) -> Option<Vec<T>> {
        let Self::Texture { format, bytes, .. } = self else {
            return None;
        };
        let (own_kind, width) = layout(*format)?;
        (own_kind == kind).then(|| bytes.chunks_exact(width).map(decode).collect())
    }
}

/// Number types of a format's channels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Uint,
    Sint,
    Unorm,
    Snorm,
    Float,
}

/// Kind and bytes of each channel; `None` for packed and compressed formats.
fn layout(format: wgpu::TextureFormat) -> Option<(Kind, usize)> {
    use wgpu::TextureFormat as F;
    Some(match format {
        F::R8Uint | F::Rg8Uint | F::Rgba8Uint | F::Stencil8 => (Kind::Uint, 1),
        F::R16Uint | F::Rg16Uint | F::Rgba16Uint => (Kind::Uint, 2),
        F::R32Uint | F::Rg32Uint | F::Rgba32Uint => (Kind::Uint, 4),
        F::R8Sint | F::Rg8Sint | F::Rgba8Sint => (Kind::Sint, 1),
        F::R16Sint | F::Rg16Sint | F::Rgba16Sint => (Kind::Sint, 2),
        F::R32Sint | F::Rg32Sint | F::Rgba32Sint => (Kind::Sint, 4),
        F::R8Unorm | F::Rg8Unorm | F::Rgba8Unorm | F::Rgba8UnormSrgb => (Kind::Unorm, 1),
        F::Bgra8Unorm | F::Bgra8UnormSrgb => (Kind::Unorm, 1),
        F::R16Unorm | F::Rg16Unorm | F::Rgba16Unorm | F::Depth16Unorm => (Kind::Unorm, 2),
        F::R8Snorm | F::Rg8Snorm | F::Rgba8Snorm => (Kind::Snorm, 1),
        F::R16Snorm | F::Rg16Snorm | F::Rgba16Snorm => (Kind::Snorm, 2),
        F::R16Float | F::Rg16Float | F::Rgba16Float => (Kind::Float, 2),
        F::R32Float | F::Rg32Float | F::Rgba32Float | F::Depth32Float => (Kind::Float, 4),
        _ => return None,
    })
}

/// A little-endian integer of one, two or four bytes.
fn unsigned(bytes: &[u8]) -> u32 {
    let bytes = bytes.iter().rev();
    bytes.fold(0, |value, byte| value << 8 | u32::from(*byte))
}

/// A little-endian two's complement integer of one, two or four bytes.
fn signed(bytes: &[u8]) -> i32 {
    let unused = 32 - 8 * bytes.len() as u32;
    (unsigned(bytes) << unused).cast_signed() >> unused
}

#[cfg(test)]
mod tests {
    use super::*;
    use wgpu::TextureFormat as F;

    fn texels(format: F, bytes: &[u8]) -> Content {
        Content::Texture {
            format,
            parts: vec![[1, 1]],
            bytes: bytes.to_vec(),
        }
    }

    #[test]
    fn integers_of_every_width_keep_their_sign() {
        assert_eq!(texels(F::Rg8Uint, &[1, 255]).as_u32().unwrap(), [1, 255]);
        assert_eq!(texels(F::R16Uint, &[1, 2]).as_u32().unwrap(), [0x0201]);
        assert_eq!(texels(F::R8Sint, &[0x80]).as_i32().unwrap(), [-128]);
        assert_eq!(texels(F::R16Sint, &[0xff, 0xff]).as_i32().unwrap(), [-1]);
        let least = texels(F::R32Sint, &[0, 0, 0, 0x80]);
        assert_eq!(least.as_i32().unwrap(), [i32::MIN]);
        assert_eq!((least.as_u32(), least.as_f32()), (None, None));
    }

    #[test]
    fn normalised_integers_reach_both_ends() {
        let ends = texels(F::Rg8Snorm, &[0x80, 0x7f]).as_f32().unwrap();
        assert_eq!(ends, [-1.0, 1.0]);
        assert_eq!(
            texels(F::Depth16Unorm, &[255, 255]).as_f32().unwrap(),
            [1.0]
        );
        let blue_first = texels(F::Bgra8Unorm, &[255, 0, 0, 255]).as_f32().unwrap();
        assert_eq!(blue_first, [0.0, 0.0, 1.0, 1.0]);
    }

    #[test]
    fn half_floats_are_read() {
        let halves = texels(F::Rg16Float, &[0x00, 0x3c, 0x00, 0xc0]);
        assert_eq!(halves.as_f32().unwrap(), [1.0, -2.0]);
    }
}
