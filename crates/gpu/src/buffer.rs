//! Creates and fills buffers.

use crate::error::ExecuteError;

/// Creates a buffer that is not mapped.
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

/// Creates a buffer that is mapped at once.
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

/// Creates a buffer with the given content.
///
/// # Errors
/// An internal error with the text `failed` if the buffer cannot be written.
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

/// Fills the whole of a mapped buffer.
///
/// # Errors
/// An internal error with the text `failed` if the buffer is not mapped.
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
