//! Bringing outputs back to the host: asked for per frame, copied behind the frame, mapped after
//! submission.

use crate::{
    error::ExecuteError,
    memory::{
        allocation::extent,
        memory::{Memory, bytes as byte_range},
        physical::PingPong,
    },
};
use skiagraph_graph::{Plan, ResourceKind, Target, Texture};
use std::{
    ops::Range,
    sync::mpsc::{Receiver, channel},
    time::Duration,
};

/// An output or capture on the host.
#[derive(Clone, Debug, PartialEq)]
pub struct Readback {
    /// Its name.
    pub name: String,
    /// Its content.
    pub content: Content,
}

/// Bytes of a texture or buffer.
#[derive(Clone, Debug, PartialEq)]
pub enum Content {
    /// The mips and layers of an output.
    Texture {
        /// Format of the texels.
        format: wgpu::TextureFormat,
        /// Size in texels of each mip of each layer (or slice): the layers of the first mip, then
        /// those of the next.
        parts: Vec<[u32; 2]>,
        /// Rows from the top, tightly packed, one part after the other.
        bytes: Vec<u8>,
    },
    /// The buffer, or those of its items that the output is.
    Buffer(Vec<u8>),
}

impl Content {
    /// Width and height of the first mip of a texture.
    pub fn size(&self) -> Option<[u32; 2]> {
        match self {
            Self::Texture { parts, .. } => parts.first().copied(),
            Self::Buffer(_) => None,
        }
    }

    /// Each mip of each layer of a texture by itself.
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

    /// The raw bytes.
    pub fn bytes(&self) -> &[u8] {
        match self {
            Self::Texture { bytes, .. } | Self::Buffer(bytes) => bytes,
        }
    }

    /// Channels of the texels of a `Uint` texture, one texel after the other, or the words of a
    /// buffer.
    pub fn as_u32(&self) -> Option<Vec<u32>> {
        match self {
            Self::Buffer(bytes) => Some(bytes.chunks_exact(4).map(unsigned).collect()),
            Self::Texture { .. } => self.channels(Kind::Uint, unsigned),
        }
    }

    /// Channels of the texels of a `Sint` texture, one texel after the other.
    pub fn as_i32(&self) -> Option<Vec<i32>> {
        self.channels(Kind::Sint, signed)
    }

    /// Channels of the texels of a texture of floats, depths or normalised integers, one texel
    /// after the other, in the order red, green, blue, alpha. Those of an sRGB texture come as they
    /// are stored.
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
            values
                .chunks_exact_mut(4)
                .for_each(|texel| texel.swap(0, 2));
        }
        Some(values)
    }

    /// The channels of a texture whose format is of this kind.
    fn channels<T>(&self, kind: Kind, decode: impl Fn(&[u8]) -> T) -> Option<Vec<T>> {
        let Self::Texture { format, bytes, .. } = self else {
            return None;
        };
        let (of, width) = layout(*format)?;
        (of == kind).then(|| bytes.chunks_exact(width).map(decode).collect())
    }
}

/// After the device was polled the mapping is done, but where several threads poll one device
/// another one may still be about to say so.
pub(crate) const CALLBACK: Duration = Duration::from_secs(10);

/// What the channels of a format are.
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
    bytes
        .iter()
        .rev()
        .fold(0, |value, byte| value << 8 | u32::from(*byte))
}

/// The same in two's complement.
fn signed(bytes: &[u8]) -> i32 {
    let unused = 32 - 8 * bytes.len() as u32;
    (unsigned(bytes) << unused).cast_signed() >> unused
}

/// A mip of what is copied, with all layers of it that are read back.
struct MipCopy {
    mip: u32,
    layer: u32,
    size: wgpu::Extent3d,
    /// Bytes of a row in the staging buffer.
    row: u32,
    /// Where it stands in the staging buffer.
    offset: u64,
}

/// What is read back.
enum Source {
    Texture(wgpu::Texture, Vec<MipCopy>),
    /// Of a buffer these bytes.
    Buffer(wgpu::Buffer, Range<u64>),
}

/// A readback under way.
pub(crate) struct Pending {
    name: String,
    staging: wgpu::Buffer,
    source: Source,
    mapped: Option<Receiver<Result<(), wgpu::BufferAsyncError>>>,
}

impl Pending {
    /// Makes the staging buffer of an output or capture.
    pub fn new(
        device: &wgpu::Device,
        plan: &Plan,
        memory: &Memory,
        ping_pong: &PingPong,
        name: &str,
    ) -> Result<Self, ExecuteError> {
        let mut readable = plan.readable().iter();
        let Some((_, target)) = readable.find(|(known, _)| known == name) else {
            let known: Vec<&str> = plan
                .readable()
                .iter()
                .map(|(name, _)| name.as_str())
                .collect();
            return Err(ExecuteError::NoSuchOutput {
                name: name.to_owned(),
                known: known.join(", "),
            });
        };
        // What the graph made can be copied from; what the host made may not.
        let refuse = |usage: &'static str| ExecuteError::NotReadable {
            name: name.to_owned(),
            usage,
        };
        let (source, size) = match &plan.resource(target.id).kind {
            ResourceKind::Texture(texture) => {
                let made = memory.texture(target.id, ping_pong)?.clone();
                if !made.usage().contains(wgpu::TextureUsages::COPY_SRC) {
                    return Err(refuse("TextureUsages::COPY_SRC"));
                }
                let (mips, size) = mips(texture, target);
                (Source::Texture(made, mips), size)
            }
            _ => {
                let buffer = memory.buffer(target.id, ping_pong)?.clone();
                if !buffer.usage().contains(wgpu::BufferUsages::COPY_SRC) {
                    return Err(refuse("BufferUsages::COPY_SRC"));
                }
                let whole = buffer.size();
                let bytes = byte_range(plan.resource(target.id), &target.part, whole);
                let copied = copied(&bytes);
                (Source::Buffer(buffer, bytes), copied.end - copied.start)
            }
        };
        let staging = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("readback"),
            size,
            usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        Ok(Self {
            name: name.to_owned(),
            staging,
            source,
            mapped: None,
        })
    }

    /// Encodes the copy into the staging buffer.
    pub fn copy(&self, encoder: &mut wgpu::CommandEncoder) {
        let (texture, mips) = match &self.source {
            Source::Texture(texture, mips) => (texture, mips),
            Source::Buffer(buffer, bytes) => {
                let Range { start, end } = copied(bytes);
                encoder.copy_buffer_to_buffer(buffer, start, &self.staging, 0, end - start);
                return;
            }
        };
        for copy in mips {
            let mut source = texture.as_image_copy();
            source.mip_level = copy.mip;
            source.origin.z = copy.layer;
            let layout = wgpu::TexelCopyBufferLayout {
                offset: copy.offset,
                bytes_per_row: Some(copy.row),
                rows_per_image: Some(copy.size.height),
            };
            let target = wgpu::TexelCopyBufferInfo {
                buffer: &self.staging,
                layout,
            };
            encoder.copy_texture_to_buffer(source, target, copy.size);
        }
    }

    /// Starts the mapping; the frame must have been submitted.
    pub fn map(&mut self) {
        // The host may say twice that it has submitted.
        if self.mapped.is_some() {
            return;
        }
        let (send, receive) = channel();
        self.staging
            .map_async(wgpu::MapMode::Read, .., move |result| {
                // The receiver is gone if the executor was dropped meanwhile; nobody wants the
                // bytes then.
                let _ = send.send(result);
            });
        self.mapped = Some(receive);
    }

    /// The content, after the device was polled until the mapping was done.
    pub fn take(self) -> Result<Readback, ExecuteError> {
        let failed = || ExecuteError::Readback {
            name: self.name.clone(),
        };
        let mapped = self.mapped.as_ref().ok_or_else(failed)?;
        mapped
            .recv_timeout(CALLBACK)
            .map_err(|_| failed())?
            .map_err(|_| failed())?;
        let bytes = self
            .staging
            .get_mapped_range(..)
            .map_err(|_| failed())?
            .to_vec();
        let content = match self.source {
            Source::Texture(texture, mips) => unpadded(texture.format(), &mips, &bytes),
            Source::Buffer(_, asked) => {
                let start = (asked.start - copied(&asked).start) as usize;
                let length = (asked.end - asked.start) as usize;
                Content::Buffer(bytes[start..][..length].to_vec())
            }
        };
        Ok(Readback {
            name: self.name,
            content,
        })
    }
}

/// The bytes that are copied for those that are asked for: items may be smaller than what can be
/// copied.
fn copied(bytes: &Range<u64>) -> Range<u64> {
    let least = wgpu::COPY_BUFFER_ALIGNMENT;
    bytes.start / least * least..bytes.end.next_multiple_of(least)
}

/// The mips of a part of a texture in a staging buffer, and the bytes of all.
fn mips(texture: &Texture, target: &Target) -> (Vec<MipCopy>, u64) {
    let texel = texture.format.block_copy_size(None).unwrap_or(4);
    let layers = &target.part.layers;
    let mut offset = 0;
    let mip = |mip: u32| {
        let until = layers.end.min(texture.mip_layers(mip));
        let size = extent(texture, mip, until.saturating_sub(layers.start));
        let row = (size.width * texel).next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
        let copy = MipCopy {
            mip,
            layer: layers.start,
            size,
            row,
            offset,
        };
        offset += u64::from(row) * u64::from(size.height) * u64::from(size.depth_or_array_layers);
        copy
    };
    let mips = target.part.mips.clone().map(mip).collect();
    (mips, offset)
}

/// What stands in a staging buffer, without the padding between rows.
fn unpadded(format: wgpu::TextureFormat, mips: &[MipCopy], staging: &[u8]) -> Content {
    let texel = format.block_copy_size(None).unwrap_or(4);
    let (mut parts, mut bytes) = (Vec::new(), Vec::new());
    for copy in mips {
        let rows = staging[copy.offset as usize..].chunks(copy.row as usize);
        let count = copy.size.height * copy.size.depth_or_array_layers;
        let tight = (copy.size.width * texel) as usize;
        rows.take(count as usize)
            .for_each(|row| bytes.extend_from_slice(&row[..tight]));
        let part = [copy.size.width, copy.size.height];
        parts.extend((0..copy.size.depth_or_array_layers).map(|_| part));
    }
    Content::Texture {
        format,
        parts,
        bytes,
    }
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
