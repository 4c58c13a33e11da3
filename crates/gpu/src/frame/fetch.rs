//! Reads outputs back to the host: requested for a frame, copied after its passes, and mapped when
//! the host submits it.

use super::{encode::layers_from, read_buffer::ReadBuffer};
use crate::error::ExecuteError;
use crate::memory::allocation::extent;
use crate::memory::memory::InFrame;
use crate::readback::{Content, Readback};
use crate::signal::Progress;
use skiagraph_graph::{Plan, ResourceKind, SubresourceRange, Target, Texture};
use std::{ops::Range, sync::Arc};

/// An output or capture of a plan, and the copies that read it back.
#[derive(Debug)]
pub(super) struct Readable {
    name: String,
    target: Target,
    /// Copies of a texture's mips; empty for a buffer.
    mips: Vec<MipCopy>,
}

/// Copy of one mip of a texture, with all its layers that are read back.
#[derive(Debug)]
pub(super) struct MipCopy {
    mip: u32,
    layer: u32,
    pub size: wgpu::Extent3d,
    /// Bytes of a row in the staging buffer, with padding.
    row: u32,
    /// Offset of the mip in the staging buffer, in bytes.
    offset: u64,
}

impl MipCopy {
    pub fn bytes(&self) -> u64 {
        let [height, layers] = [self.size.height, self.size.depth_or_array_layers].map(u64::from);
        u64::from(self.row) * height * layers
    }

    pub fn in_texture<'t>(&self, texture: &'t wgpu::Texture) -> wgpu::TexelCopyTextureInfo<'t> {
        layers_from(texture, self.mip, self.layer)
    }

    pub fn in_buffer<'b>(
        &self,
        buffer: &'b wgpu::Buffer,
        offset: u64,
    ) -> wgpu::TexelCopyBufferInfo<'b> {
        let layout = wgpu::TexelCopyBufferLayout {
            offset,
            bytes_per_row: Some(self.row),
            rows_per_image: Some(self.size.height),
        };
        wgpu::TexelCopyBufferInfo { buffer, layout }
    }
}

impl Readable {
    /// Returns the outputs and captures of a plan.
    pub fn all(plan: &Plan) -> Vec<Arc<Self>> {
        let readable = |(name, target): &(String, Target)| {
            let mips = match &plan.resource(target.id).kind {
                ResourceKind::Texture(texture) => mips(texture, &target.part),
                _ => Vec::new(),
            };
            Arc::new(Self {
                name: name.clone(),
                target: target.clone(),
                mips,
            })
        };
        plan.readable().iter().map(readable).collect()
    }

    fn source(&self, frame: InFrame<'_>) -> Result<Source, ExecuteError> {
        // Resources that the graph made can be copied from; the host's may not.
        let refuse = |usage: &'static str| ExecuteError::NotReadable {
            name: self.name.clone(),
            usage,
        };
        let id = self.target.id;
        if let ResourceKind::Texture(_) = &frame.plan.resource(id).kind {
            let texture = frame.texture(id)?.clone();
            if !texture.usage().contains(wgpu::TextureUsages::COPY_SRC) {
                return Err(refuse("TextureUsages::COPY_SRC"));
            }
            return Ok(Source::Texture(texture));
        }
        let (buffer, bytes) = frame.bytes(&self.target)?;
        if !buffer.usage().contains(wgpu::BufferUsages::COPY_SRC) {
            return Err(refuse("BufferUsages::COPY_SRC"));
        }
        Ok(Source::Buffer(buffer.clone(), bytes))
    }
}

/// Source of a readback.
enum Source {
    Texture(wgpu::Texture),
    /// A range of bytes of a buffer.
    Buffer(wgpu::Buffer, Range<u64>),
}

/// A readback in flight.
pub(super) struct Fetch {
    readable: Arc<Readable>,
    source: Source,
    staging: ReadBuffer,
}

/// Staging buffers that wait for their next use.
#[derive(Default)]
pub(super) struct StagingPool(Vec<ReadBuffer>);

impl StagingPool {
    fn take(&mut self, size: u64) -> Option<ReadBuffer> {
        let mut spares = self.0.iter();
        let spare = spares.position(|spare| spare.buffer.size() == size)?;
        Some(self.0.swap_remove(spare))
    }

    /// Drops all buffers; another plan may have no use for them.
    pub fn clear(&mut self) {
        self.0.clear();
    }
}

impl Fetch {
    /// Takes a staging buffer for an output or capture, or makes one.
    pub fn new(
        name: &str,
        readable: &[Arc<Readable>],
        frame: InFrame<'_>,
        pool: &mut StagingPool,
        device: &wgpu::Device,
    ) -> Result<Self, ExecuteError> {
        let Some(readable) = readable.iter().find(|output| output.name == name) else {
            let names: Vec<&str> = readable.iter().map(|output| output.name.as_str()).collect();
            return Err(ExecuteError::NoSuchOutput {
                name: name.to_owned(),
                known: names.join(", "),
            });
        };
        let source = readable.source(frame)?;
        let size = match &source {
            Source::Texture(_) => readable.mips.iter().map(MipCopy::bytes).sum(),
            Source::Buffer(_, bytes) => copied(bytes).end - copied(bytes).start,
        };
        let staging = match pool.take(size) {
            Some(spare) => spare,
            None => ReadBuffer::new(device, name, "readback", size)?,
        };
        Ok(Self {
            readable: readable.clone(),
            source,
            staging,
        })
    }

    /// Encodes the copy into the staging buffer, which is mapped when the encoder is submitted.
    pub fn copy(&self, encoder: &mut wgpu::CommandEncoder) {
        let buffer = &self.staging.buffer;
        match &self.source {
            Source::Texture(texture) => {
                for copy in &self.readable.mips {
                    let to = copy.in_buffer(buffer, copy.offset);
                    encoder.copy_texture_to_buffer(copy.in_texture(texture), to, copy.size);
                }
            }
            Source::Buffer(source, bytes) => {
                let Range { start, end } = copied(bytes);
                encoder.copy_buffer_to_buffer(source, start, buffer, 0, end - start);
            }
        }
        self.staging.map(encoder);
    }

    /// True until the mapping of the staging buffer is known to be done or refused.
    pub fn is_being_mapped(&self) -> bool {
        self.staging.is_being_mapped()
    }

    /// Returns the content of a finished frame's output or capture.
    pub fn take(self, pool: &mut StagingPool) -> Result<Readback, ExecuteError> {
        let Self {
            readable,
            source,
            staging,
        } = self;
        let failed = || ExecuteError::Readback {
            name: readable.name.clone(),
        };
        if staging.is_being_mapped() {
            return Err(failed());
        }
        let content = staging.take(|mapped| match source {
            Source::Texture(texture) => unpadded(texture.format(), &readable.mips, mapped),
            Source::Buffer(_, asked) => {
                let start = (asked.start - copied(&asked).start) as usize;
                let length = (asked.end - asked.start) as usize;
                Content::Buffer(mapped[start..][..length].to_vec())
            }
        });
        let content = content.ok_or_else(failed)?;
        pool.0.push(staging);
        Ok(Readback {
            name: readable.name.clone(),
            content,
        })
    }

    /// Returns the staging buffer of a frame that never ran to the pool. One that is mapped, as
    /// those of refused commands are, is dropped.
    pub fn give_up(self, pool: &mut StagingPool) {
        let is_unmapped = self.staging.buffer.get_mapped_range(..).is_err();
        if self.staging.progress() == Progress::Dropped && is_unmapped {
            pool.0.push(self.staging);
        }
    }
}

/// Extends a byte range to the alignment of copies; items may be smaller.
fn copied(bytes: &Range<u64>) -> Range<u64> {
    let least = wgpu::COPY_BUFFER_ALIGNMENT;
    bytes.start / least * least..bytes.end.next_multiple_of(least)
}

/// Returns the copies of a texture part's mips, with their places in a staging buffer.
pub(super) fn mips(texture: &Texture, part: &SubresourceRange) -> Vec<MipCopy> {
    let texel = texture.format.block_copy_size(None).unwrap_or(4);
    let layers = &part.layers;
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
        offset += copy.bytes();
        copy
    };
    part.mips.clone().map(mip).collect()
}

/// Returns the content of a staging buffer, without the padding between rows.
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
