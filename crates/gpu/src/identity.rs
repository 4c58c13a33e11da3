//! Tells which device a thing of wgpu belongs to.
//!
//! wgpu compares devices, buffers and textures by numbers that each instance counts for itself: the
//! first devices of two instances are equal to it, and a buffer of one is bound as another one's.
//! But each complaint reaches the error scopes of its own device alone. So a thing is made to
//! complain, which changes nothing of it, and a scope of the device in question hears that or not.

use skiagraph_graph::caught;
use std::sync::atomic::{AtomicU64, Ordering};

/// A wgpu device, told apart from every other one, also from those of other instances: `==` of
/// wgpu's devices holds for the first devices of two instances.
#[derive(Clone, Debug)]
pub struct DeviceIdentity {
    device: wgpu::Device,
    /// No other identity of the process has it, but for clones.
    pub(crate) number: u64,
}

impl DeviceIdentity {
    /// Creates an identity of a device. A host makes one when it makes the things that it tells
    /// apart by it, and keeps it beside them.
    pub fn new(device: &wgpu::Device) -> Self {
        static NEXT: AtomicU64 = AtomicU64::new(1);
        Self {
            device: device.clone(),
            number: NEXT.fetch_add(1, Ordering::Relaxed),
        }
    }

    /// Returns the device.
    pub fn device(&self) -> &wgpu::Device {
        &self.device
    }

    /// Returns true if `device` is this device, or a clone of its handle; false also if it is lost.
    pub fn is(&self, device: &wgpu::Device) -> bool {
        if self.device != *device {
            return false;
        }
        if cfg!(target_arch = "wasm32") {
            return true;
        }
        // The other device's host has no part in it.
        let _own = self.device.push_error_scope(wgpu::ErrorFilter::Validation);
        let without_usage = wgpu::BufferDescriptor {
            label: None,
            size: 4,
            usage: wgpu::BufferUsages::empty(),
            mapped_at_creation: false,
        };
        hears(device, || drop(self.device.create_buffer(&without_usage)))
    }

    /// Returns true if a buffer is of this device. One that is mapped, or may be, is not asked, and
    /// counts as such.
    pub fn has_buffer(&self, buffer: &wgpu::Buffer) -> bool {
        has_buffer(&self.device, buffer)
    }
}

/// True if the device hears the complaint. That of another device goes to the handler of its host,
/// whose panic, wgpu's default, is caught.
pub(crate) fn hears(device: &wgpu::Device, complain: impl FnOnce()) -> bool {
    let scope = device.push_error_scope(wgpu::ErrorFilter::Validation);
    let _ = caught(complain);
    // A browser tells later, and has handles that know their device.
    cfg!(target_arch = "wasm32") || pollster::block_on(scope.pop()).is_some()
}

/// [`DeviceIdentity::has_buffer`].
pub(crate) fn has_buffer(device: &wgpu::Device, buffer: &wgpu::Buffer) -> bool {
    if cfg!(target_arch = "wasm32") {
        return true;
    }
    // A buffer that the host fills is left alone.
    let maps = wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::MAP_WRITE;
    let is_idle = || {
        let mapped = buffer.get_mapped_range(..);
        mapped.is_err_and(|why| why.to_string().contains("not mapped"))
    };
    buffer.usage().intersects(maps) || !is_idle() || hears(device, || buffer.unmap())
}

/// Returns true if a queue is that of a device; `buffer` is any of the device.
pub(crate) fn has_queue(device: &wgpu::Device, queue: &wgpu::Queue, buffer: &wgpu::Buffer) -> bool {
    hears(device, || {
        // One byte at an odd place is never written, whatever buffer has that number there.
        let _ = queue.write_buffer_with(buffer, 1, wgpu::BufferSize::MIN);
    })
}
