//! Buffers, made and filled alike everywhere.

use crate::error::ExecuteError;

/// Makes a buffer that is not mapped.
pub(crate) fn make(
    device: &wgpu::Device,
    label: &str,
    size: u64,
    usage: wgpu::BufferUsages,
) -> wgpu::Buffer {
    device.create_buffer(&wgpu::BufferDescriptor {
        label: Some(label),
        size,
        usage,
        mapped_at_creation: false,
    })
}

/// Makes a buffer that is mapped from the first.
pub(crate) fn mapped(
    device: &wgpu::Device,
    label: &str,
    size: u64,
    usage: wgpu::BufferUsages,
) -> wgpu::Buffer {
    device.create_buffer(&wgpu::BufferDescriptor {
        label: Some(label),
        size,
        usage,
        mapped_at_creation: true,
    })
}

/// Makes a buffer with a content.
///
/// # Errors
/// With the words of `failed` if it cannot be written.
pub(crate) fn filled(
    device: &wgpu::Device,
    label: &str,
    content: &[u8],
    usage: wgpu::BufferUsages,
    failed: &'static str,
) -> Result<wgpu::Buffer, ExecuteError> {
    let buffer = mapped(device, label, content.len() as u64, usage);
    write(&buffer, content, failed)?;
    buffer.unmap();
    Ok(buffer)
}

/// Writes all of a mapped buffer.
///
/// # Errors
/// With the words of `failed` if it is not mapped.
pub(crate) fn write(
    buffer: &wgpu::Buffer,
    content: &[u8],
    failed: &'static str,
) -> Result<(), ExecuteError> {
    let mapped = buffer.get_mapped_range_mut(..);
    let mut mapped = mapped.map_err(|_| ExecuteError::Internal(failed))?;
    mapped.copy_from_slice(content);
    Ok(())
}
