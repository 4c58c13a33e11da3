//! What was uploaded, by name, each with the version of what is in it.

use crate::{built::How, error::Error, names::*};
use std::collections::{BTreeMap, BTreeSet};
use wgpu::util::DeviceExt;

/// Where to.
#[derive(Clone, Copy)]
pub(crate) struct On<'a> {
    pub device: &'a wgpu::Device,
    pub queue: &'a wgpu::Queue,
}

/// Buffers by the names of resources.
#[derive(Default)]
pub(crate) struct Buffers {
    held: BTreeMap<&'static str, (wgpu::Buffer, u64)>,
    /// Those that were made here: only they are written again.
    own: BTreeSet<&'static str>,
}

impl Buffers {
    /// The same buffers for another provider, which makes its own before it writes.
    pub fn shared(&self) -> Self {
        Self {
            held: self.held.clone(),
            own: BTreeSet::new(),
        }
    }

    /// The buffer of that name, if what is in it is of that version.
    pub fn of(&self, name: &str, version: u64) -> Option<&wgpu::Buffer> {
        let held = self.held.get(name).filter(|(_, of)| *of == version);
        held.map(|(buffer, _)| buffer)
    }

    /// What is in the buffer of that name, if there is one, is of that version, too.
    pub fn still_hold(&mut self, name: &str, version: u64) {
        if let Some((_, of)) = self.held.get_mut(name) {
            *of = version;
        }
    }

    /// Writes items into the buffer of that name, one zero item if there are none; makes the buffer
    /// if there is none of that size, or if another provider gives it as well.
    pub fn write<T: bytemuck::NoUninit + bytemuck::Zeroable>(
        &mut self,
        name: &'static str,
        items: &[T],
        version: u64,
        on: On,
    ) -> Result<How, Error> {
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
        if let Some((buffer, of)) = self.held.get_mut(name)
            && buffer.size() == bytes
            && self.own.contains(name)
        {
            on.queue.write_buffer(buffer, 0, content);
            *of = version;
            return Ok(How::Rewritten);
        }
        let buffer = buffer_of(name, content, usage_of(name, on.device), on.device);
        self.held.insert(name, (buffer, version));
        self.own.insert(name);
        Ok(How::Made)
    }
}

fn usage_of(name: &str, device: &wgpu::Device) -> wgpu::BufferUsages {
    let features = device.features();
    match name {
        CAMERA | UNPROJECTION | LIGHT | LIGHT_AREA => wgpu::BufferUsages::UNIFORM,
        POSITIONS | INDICES if features.contains(wgpu::Features::EXPERIMENTAL_RAY_QUERY) => {
            wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::BLAS_INPUT
        }
        _ => wgpu::BufferUsages::STORAGE,
    }
}

pub(crate) fn buffer_of(
    name: &str,
    content: &[u8],
    usage: wgpu::BufferUsages,
    device: &wgpu::Device,
) -> wgpu::Buffer {
    device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
        label: Some(name),
        contents: content,
        usage: usage | wgpu::BufferUsages::COPY_SRC | wgpu::BufferUsages::COPY_DST,
    })
}

/// The most bytes that a storage buffer can have and be bound whole.
pub(crate) fn binding_limit(device: &wgpu::Device) -> u64 {
    let limits = device.limits();
    limits
        .max_buffer_size
        .min(limits.max_storage_buffer_binding_size)
}
