//! Buffers by which bytes of a frame come back to the CPU.

use crate::buffer;
use crate::error::{ExecuteError, scoped};
use crate::signal::{Progress, Signal};

/// A buffer that a frame copies to and the host maps, for one frame after another.
pub(super) struct ReadBuffer {
    pub buffer: wgpu::Buffer,
    mapped: Signal,
}

impl ReadBuffer {
    /// Creates a buffer of so many bytes; errors are told of `name`.
    pub fn new(
        device: &wgpu::Device,
        name: &str,
        label: &str,
        size: u64,
    ) -> Result<Self, ExecuteError> {
        let usage = wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST;
        let make = || buffer::make(device, label, size, usage);
        Ok(Self {
            buffer: scoped(device, name, make)?,
            mapped: Signal::default(),
        })
    }

    /// Has the buffer mapped when the encoder is submitted.
    pub fn map(&self, encoder: &wgpu::CommandEncoder) {
        self.mapped
            .when_mapped(&self.buffer, wgpu::MapMode::Read, encoder);
    }

    /// Returns the progress of the mapping.
    pub fn progress(&self) -> Progress {
        self.mapped.progress()
    }

    /// True until the mapping is known to be done or refused.
    pub fn is_being_mapped(&self) -> bool {
        self.progress() == Progress::UnderWay
    }

    /// Reads the mapped bytes, and unmaps the buffer for the next frame; `None` if it is not
    /// mapped.
    pub fn take<T>(&self, read: impl FnOnce(&[u8]) -> T) -> Option<T> {
        let mapped = self.buffer.get_mapped_range(..).ok()?;
        let taken = read(&mapped);
        drop(mapped);
        self.buffer.unmap();
        Some(taken)
    }
}
