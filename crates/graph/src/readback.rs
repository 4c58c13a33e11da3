//! Bringing outputs back to the host: asked for per frame, copied behind the frame, mapped after submission.

use crate::{
    execute::ExecuteError,
    memory::{Histories, Memory},
    plan::Plan,
    resolve::{Part, ResourceKind, Target},
};
use std::{
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
    /// Mip 0, layer 0 of the output's part.
    Texture {
        /// Format of the texels.
        format: wgpu::TextureFormat,
        /// Width and height in texels.
        size: [u32; 2],
        /// Rows from the top, tightly packed.
        bytes: Vec<u8>,
    },
    /// The whole buffer.
    Buffer(Vec<u8>),
}

impl Content {
    /// The raw bytes.
    pub fn bytes(&self) -> &[u8] {
        match self {
            Self::Texture { bytes, .. } | Self::Buffer(bytes) => bytes,
        }
    }

    /// Texels of an R8Uint, R16Uint or R32Uint texture, or the words of a buffer.
    pub fn as_u32(&self) -> Option<Vec<u32>> {
        let words = |bytes: &[u8]| {
            bytes
                .chunks_exact(4)
                .map(|b| u32::from_le_bytes([b[0], b[1], b[2], b[3]]))
                .collect()
        };
        match self {
            Self::Buffer(bytes) => Some(words(bytes)),
            Self::Texture { format, bytes, .. } => match format {
                wgpu::TextureFormat::R8Uint => Some(bytes.iter().map(|&b| u32::from(b)).collect()),
                wgpu::TextureFormat::R16Uint => Some(
                    bytes
                        .chunks_exact(2)
                        .map(|b| u32::from(u16::from_le_bytes([b[0], b[1]])))
                        .collect(),
                ),
                wgpu::TextureFormat::R32Uint => Some(words(bytes)),
                _ => None,
            },
        }
    }

    /// Channels of a texture of 32-bit floats or depths, of R8Unorm or R16Float, one after the other.
    pub fn as_f32(&self) -> Option<Vec<f32>> {
        let Self::Texture { format, bytes, .. } = self else {
            return None;
        };
        match format {
            wgpu::TextureFormat::R32Float
            | wgpu::TextureFormat::Rg32Float
            | wgpu::TextureFormat::Rgba32Float
            | wgpu::TextureFormat::Depth32Float => Some(
                bytes
                    .chunks_exact(4)
                    .map(|b| f32::from_le_bytes([b[0], b[1], b[2], b[3]]))
                    .collect(),
            ),
            wgpu::TextureFormat::R8Unorm => {
                Some(bytes.iter().map(|&b| f32::from(b) / 255.0).collect())
            }
            wgpu::TextureFormat::R16Float => Some(
                bytes
                    .chunks_exact(2)
                    .map(|b| half::f16::from_le_bytes([b[0], b[1]]).to_f32())
                    .collect(),
            ),
            _ => None,
        }
    }
}

/// After the device was polled the mapping is done, but where several threads poll one device another one may still be about to
/// say so.
const CALLBACK: Duration = Duration::from_secs(10);

/// What is read back.
enum Source {
    Texture {
        texture: wgpu::Texture,
        part: Part,
        size: [u32; 2],
        /// Bytes of a row in the staging buffer.
        row: u32,
    },
    Buffer(wgpu::Buffer),
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
        histories: &Histories,
        name: &str,
    ) -> Result<Self, ExecuteError> {
        let Some((_, target)) = plan.readable.iter().find(|(known, _)| known == name) else {
            let known: Vec<&str> = plan
                .readable
                .iter()
                .map(|(name, _)| name.as_str())
                .collect();
            return Err(ExecuteError::NoSuchOutput {
                name: name.to_owned(),
                known: known.join(", "),
            });
        };
        let Target { id, part } = target;
        // What the graph made can be copied from; what the host made may not.
        let refuse = |usage: &'static str| ExecuteError::NotReadable {
            name: name.to_owned(),
            usage,
        };
        let (source, size) = match &plan.resources[id.0].kind {
            ResourceKind::Texture(texture) => {
                let size = texture.size.map(|edge| (edge >> part.mips.start).max(1));
                let texel = texture.format.block_copy_size(None).unwrap_or(4);
                let row = (size[0] * texel).next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
                let made = memory.texture(*id, histories)?.clone();
                if !made.usage().contains(wgpu::TextureUsages::COPY_SRC) {
                    return Err(refuse("TextureUsages::COPY_SRC"));
                }
                let source = Source::Texture {
                    texture: made,
                    part: part.clone(),
                    size,
                    row,
                };
                (source, u64::from(row) * u64::from(size[1]))
            }
            _ => {
                let buffer = memory.buffer(*id, histories)?.clone();
                if !buffer.usage().contains(wgpu::BufferUsages::COPY_SRC) {
                    return Err(refuse("BufferUsages::COPY_SRC"));
                }
                let size = buffer.size();
                (Source::Buffer(buffer), size)
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
        match &self.source {
            Source::Texture {
                texture,
                part,
                size,
                row,
            } => encoder.copy_texture_to_buffer(
                wgpu::TexelCopyTextureInfo {
                    texture,
                    mip_level: part.mips.start,
                    origin: wgpu::Origin3d {
                        x: 0,
                        y: 0,
                        z: part.layers.start,
                    },
                    aspect: wgpu::TextureAspect::All,
                },
                wgpu::TexelCopyBufferInfo {
                    buffer: &self.staging,
                    layout: wgpu::TexelCopyBufferLayout {
                        offset: 0,
                        bytes_per_row: Some(*row),
                        rows_per_image: None,
                    },
                },
                wgpu::Extent3d {
                    width: size[0],
                    height: size[1],
                    depth_or_array_layers: 1,
                },
            ),
            Source::Buffer(buffer) => {
                encoder.copy_buffer_to_buffer(buffer, 0, &self.staging, 0, buffer.size());
            }
        }
    }

    /// Starts the mapping; the frame must have been submitted.
    pub fn map(&mut self) {
        let (send, receive) = channel();
        self.staging
            .map_async(wgpu::MapMode::Read, .., move |result| {
                // The receiver is gone if the executor was dropped meanwhile; nobody wants the bytes then.
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
            Source::Texture {
                texture, size, row, ..
            } => {
                let format = texture.format();
                let tight = (size[0] * format.block_copy_size(None).unwrap_or(4)) as usize;
                let rows = bytes
                    .chunks(row as usize)
                    .flat_map(|row| &row[..tight])
                    .copied()
                    .collect();
                Content::Texture {
                    format,
                    size,
                    bytes: rows,
                }
            }
            Source::Buffer(_) => Content::Buffer(bytes),
        };
        Ok(Readback {
            name: self.name,
            content,
        })
    }
}
