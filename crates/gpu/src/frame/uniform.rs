//! The uniforms that the commands of each frame write: `frame`, with number, time and flags, and
//! those whose bytes the provider tells. The host may encode several frames before it submits the
//! first. So each frame in flight has its own source buffer, which the frame's commands copy to the
//! uniforms.

use super::host_changes::Changed;
use crate::buffer;
use crate::error::{ExecuteError, scoped};
use crate::memory::memory::Memory;
use crate::memory::physical::PingPong;
use crate::signal::{Progress, Signal};
use skiagraph_graph::FRAME_BYTES;

/// Source buffer of a frame's uniforms, one behind the other.
pub(super) struct FrameUniforms {
    staging: wgpu::Buffer,
    /// Signals when the buffer is mapped again, after its last frame has finished.
    mapped: Signal,
}

impl FrameUniforms {
    fn new(size: u64, device: &wgpu::Device) -> Result<Self, ExecuteError> {
        let usage = wgpu::BufferUsages::MAP_WRITE | wgpu::BufferUsages::COPY_SRC;
        let make = || buffer::mapped(device, NAME, size, usage);
        Ok(Self {
            staging: scoped(device, NAME, make)?,
            mapped: Signal::default(),
        })
    }

    /// Writes the contents of the uniforms into the source buffer of a finished frame, or into a
    /// new one.
    pub fn write(
        used: &mut Option<Self>,
        memory: &Memory,
        device: &wgpu::Device,
    ) -> Result<(), ExecuteError> {
        let sizes = memory.uniforms().values().map(Vec::len);
        let size = sizes.sum::<usize>() as u64;
        if size == 0 {
            *used = None;
            return Ok(());
        }
        let serves =
            |it: &Self| it.mapped.progress() == Progress::Done && it.staging.size() == size;
        let uniforms = match used.take().filter(serves) {
            Some(uniforms) => uniforms,
            None => Self::new(size, device)?,
        };
        let mapped = uniforms.staging.get_mapped_range_mut(..);
        let not_mapped = |_| ExecuteError::Internal("the source of uniforms was not mapped");
        let mut mapped = mapped.map_err(not_mapped)?;
        let mut begin = 0;
        for content in memory.uniforms().values() {
            let end = begin + content.len();
            mapped.slice(begin..end).copy_from_slice(content);
            begin = end;
        }
        drop(mapped);
        *used = Some(uniforms);
        Ok(())
    }

    /// Encodes the copies from the source buffer to the uniforms.
    pub fn copy(&mut self, memory: &Memory, encoder: &mut wgpu::CommandEncoder) {
        self.staging.unmap();
        let mut begin = 0;
        for (id, content) in memory.uniforms() {
            let size = content.len() as u64;
            if let Ok(uniform) = memory.buffer(*id, &PingPong::new()) {
                encoder.copy_buffer_to_buffer(&self.staging, begin, uniform, 0, size);
            }
            begin += size;
        }
        self.mapped
            .when_mapped(&self.staging, wgpu::MapMode::Write, encoder);
    }
}

/// Returns the content of the uniform `frame`.
pub(super) fn frame_bytes(
    (index, seconds, changed): (u32, f32, Changed),
) -> [u8; FRAME_BYTES as usize] {
    let flags = [changed.scene, changed.light, changed.memory].map(u32::from);
    let words = [index, seconds.to_bits()].into_iter().chain(flags);
    let mut bytes = [0; FRAME_BYTES as usize];
    for (bytes, word) in bytes.chunks_exact_mut(4).zip(words) {
        bytes.copy_from_slice(&word.to_ne_bytes());
    }
    bytes
}

const NAME: &str = "uniforms of a frame";
