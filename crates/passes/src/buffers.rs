//! Uploaded buffers by name, each with the version of its content.

use crate::{error::Error, lights, names::*};
use std::collections::BTreeMap;

/// Where to.
#[derive(Clone, Copy)]
pub(crate) struct On<'a> {
    pub device: &'a wgpu::Device,
    pub queue: &'a wgpu::Queue,
}

/// Buffers by the names of resources.
///
/// None is written again once it was handed out: what the queue writes comes before all that is
/// submitted later, so a frame that was encoded with the buffer and not submitted yet would show
/// what was set for another one. Another content is another buffer.
#[derive(Clone, Default)]
pub(crate) struct Buffers {
    held: BTreeMap<String, (wgpu::Buffer, u64)>,
}

impl Buffers {
    /// The buffer of that name, if what is in it is of that version.
    pub fn get(&self, name: &str, version: u64) -> Option<&wgpu::Buffer> {
        let held = self.held.get(name).filter(|(_, of)| *of == version);
        held.map(|(buffer, _)| buffer)
    }

    /// Marks the content of the buffer of that name, if there is one, as being also of that
    /// version.
    pub fn still_hold(&mut self, name: &str, version: u64) {
        if let Some((_, of)) = self.held.get_mut(name) {
            *of = version;
        }
    }

    /// Makes the buffer of that name with these items, one zero item if there are none.
    pub fn make<T: bytemuck::NoUninit + bytemuck::Zeroable>(
        &mut self,
        name: &str,
        items: &[T],
        version: u64,
        on: On,
    ) -> Result<(), Error> {
        let dummy = [T::zeroed()];
        let items = if items.is_empty() { &dummy } else { items };
        let content: &[u8] = bytemuck::cast_slice(items);
        let bytes = content.len() as u64;
        let limit = binding_limit(on.device);
        if bytes > limit {
            return Err(Error::TooLarge {
                name: name.to_owned(),
                bytes,
                limit,
            });
        }
        let usage = usage_of(name, on.device);
        let buffer = on.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some(name),
            size: bytes,
            usage: usage | wgpu::BufferUsages::COPY_SRC | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        // Nothing that was encoded reads it yet.
        on.queue.write_buffer(&buffer, 0, content);
        self.held.insert(name.to_owned(), (buffer, version));
        Ok(())
    }
}

fn usage_of(name: &str, device: &wgpu::Device) -> wgpu::BufferUsages {
    let features = device.features();
    match name {
        CAMERA | UNPROJECTION | LIGHT | LIGHT_AREA => wgpu::BufferUsages::UNIFORM,
        POSITIONS | INDICES if features.contains(wgpu::Features::EXPERIMENTAL_RAY_QUERY) => {
            wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::BLAS_INPUT
        }
        _ if lights::list_of(name).is_some() => {
            wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::STORAGE
        }
        _ => wgpu::BufferUsages::STORAGE,
    }
}

/// The most bytes that a storage buffer can have and be bound whole.
pub(crate) fn binding_limit(device: &wgpu::Device) -> u64 {
    let limits = device.limits();
    limits
        .max_buffer_size
        .min(limits.max_storage_buffer_binding_size)
}
