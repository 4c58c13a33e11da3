//! Uploaded buffers by name, each with the version of its content.

use crate::{error::Error, lights, names::*};
use std::collections::BTreeMap;

/// Number of contents that are kept of a small resource: those of views and lights that take turns.
const SMALL: usize = 16;

/// Number of contents that are kept of a hierarchy in light space: those of lights that take turns.
const LIGHT_SPACES: usize = 4;

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
/// what was set for another one. Another content is another buffer. Of cameras and lights, the last
/// contents are kept: views and lights that take turns find their own.
#[derive(Clone, Default)]
pub(crate) struct Buffers {
    /// The last one was made last.
    held: BTreeMap<String, Vec<(wgpu::Buffer, u64)>>,
    /// Version of the mesh's shape that the lights were laid over.
    shape: u64,
}

impl Buffers {
    /// Drops what was laid over another shape of the mesh.
    pub fn lay_over(&mut self, shape: u64) {
        if self.shape != shape {
            self.shape = shape;
            let is_laid = |name: &str| {
                matches!(name, LIGHT | LIGHT_SPACE_NODES)
                    || lights::list_of(name) == Some(lights::LIGHTS)
            };
            self.held.retain(|name, _| !is_laid(name));
        }
    }

    /// The buffer of that name, if there is one whose content is of that version.
    pub fn get(&self, name: &str, version: u64) -> Option<&wgpu::Buffer> {
        let held = self.held.get(name)?.iter();
        let mut held = held.filter(|(_, of)| *of == version);
        held.next().map(|(buffer, _)| buffer)
    }

    /// Marks the content of the buffer of that name that was made last, if there is one, as being
    /// of that version now.
    pub fn still_hold(&mut self, name: &str, version: u64) {
        if let Some((_, of)) = self.held.get_mut(name).and_then(|held| held.last_mut()) {
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
        let held = self.held.entry(name.to_owned()).or_default();
        if held.len() >= kept_of(name) {
            held.remove(0);
        }
        held.push((buffer, version));
        Ok(())
    }
}

/// Number of contents of a resource that are kept.
fn kept_of(name: &str) -> usize {
    match name {
        CAMERA | UNPROJECTION | LIGHT | LIGHT_AREA => SMALL,
        LIGHT_SPACE_NODES | LIGHT_SPACE_PRIMITIVES => LIGHT_SPACES,
        _ if lights::list_of(name).is_some() => SMALL,
        _ => 1,
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
