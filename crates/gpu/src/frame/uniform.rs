//! The uniform `frame`: number, time and flags. The host may encode several frames before it
//! submits the first. So each frame in flight has its own source buffer, which the frame's commands
//! copy to the uniform.

use super::host_changes::Changed;
use crate::buffer;
use crate::error::{ExecuteError, scoped};
use crate::signal::{Progress, Signal};
use skiagraph_graph::FRAME_BYTES;

/// Source buffer of the uniform `frame`.
pub(super) struct FrameUniform {
    staging: wgpu::Buffer,
    /// Signals when the buffer is mapped again, after its last frame has finished.
    mapped: Signal,
}

impl FrameUniform {
    fn new(device: &wgpu::Device) -> Result<Self, ExecuteError> {
        let usage = wgpu::BufferUsages::MAP_WRITE | wgpu::BufferUsages::COPY_SRC;
        let make = || buffer::mapped(device, "frame", FRAME_BYTES, usage);
        Ok(Self {
            staging: scoped(device, "frame", make)?,
            mapped: Signal::default(),
        })
    }

    /// Writes number, time and flags into the source buffer of a finished frame, or into a new one.
    pub fn write(
        used: &mut Option<Self>,
        (index, seconds, changed): (u32, f32, Changed),
        device: &wgpu::Device,
    ) -> Result<(), ExecuteError> {
        let is_mapped = |it: &Self| it.mapped.progress() == Progress::Done;
        let uniform = match used.take().filter(is_mapped) {
            Some(uniform) => uniform,
            None => Self::new(device)?,
        };
        let flags = [changed.scene, changed.light, changed.memory].map(u32::from);
        let words = [index, seconds.to_bits()].into_iter().chain(flags);
        let mut bytes = [0; FRAME_BYTES as usize];
        for (bytes, word) in bytes.chunks_exact_mut(4).zip(words) {
            bytes.copy_from_slice(&word.to_ne_bytes());
        }
        let failed = "the uniform `frame` was not mapped";
        buffer::write(&uniform.staging, &bytes, failed)?;
        *used = Some(uniform);
        Ok(())
    }

    /// Encodes the copy from the source buffer to the uniform.
    pub fn copy(&mut self, uniform: &wgpu::Buffer, encoder: &mut wgpu::CommandEncoder) {
        self.staging.unmap();
        encoder.copy_buffer_to_buffer(&self.staging, 0, uniform, 0, FRAME_BYTES);
        self.mapped
            .when_mapped(&self.staging, wgpu::MapMode::Write, encoder);
    }
}
