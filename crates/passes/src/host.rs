//! Inputs of a preset from a host program's own resources.

use skiagraph_scene::{Indexed, IndexedError, Mesh};
use std::sync::mpsc;

/// A mesh in vertex and index buffers of a host.
///
/// Presets need positions on the CPU as well: light space is laid around them, and hierarchies and
/// adjacency are made of them.
#[derive(Clone, Copy, Debug)]
pub struct GpuMesh<'a> {
    /// Vertices, one behind the other, in a buffer with `COPY_SRC`.
    pub vertices: wgpu::BufferSlice<'a>,
    /// Bytes from one vertex to the next.
    pub stride: usize,
    /// Where in a vertex its position is, three f32.
    pub position: usize,
    /// Where its normal is, three f32; without, faces are flat.
    pub normal: Option<usize>,
    /// Three indices for each triangle, in a buffer with `COPY_SRC`.
    pub indices: wgpu::BufferSlice<'a>,
    /// Type of an index.
    pub format: wgpu::IndexFormat,
}

/// Why a [`GpuMesh`] cannot be read.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum GpuMeshError {
    /// A buffer without `COPY_SRC`.
    #[error("the buffer of {0} cannot be read: it needs the usage COPY_SRC")]
    Usage(
        /// `vertices` or `indices`.
        &'static str,
    ),
    /// A part of a buffer that cannot be copied.
    #[error("the {0} lie at an offset, or in a buffer, that is not divisible by 4")]
    Alignment(
        /// `vertices` or `indices`.
        &'static str,
    ),
    /// A vertex that is too short for what is in it.
    #[error("{what} at byte {at} does not fit a vertex of {stride} bytes")]
    Vertex {
        /// `position` or `normal`.
        what: &'static str,
        /// Where it should be.
        at: usize,
        /// Bytes of a vertex.
        stride: usize,
    },
    /// Numbers that are no mesh.
    #[error(transparent)]
    Mesh(#[from] IndexedError),
    /// The device gave nothing back.
    #[error("the {what} could not be read back: {why}")]
    Device {
        /// `vertices` or `indices`.
        what: &'static str,
        /// wgpu's reason.
        why: String,
    },
}

impl GpuMesh<'_> {
    /// Copies the mesh back, once, and welds it. Waits for the GPU: nothing for a frame.
    ///
    /// # Errors
    /// Buffers that cannot be read, and numbers that are no mesh.
    pub fn read(&self, device: &wgpu::Device, queue: &wgpu::Queue) -> Result<Mesh, GpuMeshError> {
        let stride = self.stride;
        let parts = [("position", Some(self.position)), ("normal", self.normal)];
        for (what, at) in parts {
            if let Some(at) = at.filter(|at| at.saturating_add(12) > stride) {
                return Err(GpuMeshError::Vertex { what, at, stride });
            }
        }
        let vertices = read("vertices", self.vertices, device, queue)?;
        let vectors = |at: usize| -> Vec<[f32; 3]> {
            let vertices = vertices.chunks_exact(stride);
            vertices
                .map(|it| bytemuck::pod_read_unaligned(&it[at..at + 12]))
                .collect()
        };
        let indices = read("indices", self.indices, device, queue)?;
        let indices: Vec<u32> = match self.format {
            wgpu::IndexFormat::Uint32 => bytemuck::pod_collect_to_vec(&indices),
            wgpu::IndexFormat::Uint16 => {
                let indices: Vec<u16> = bytemuck::pod_collect_to_vec(&indices);
                indices.into_iter().map(u32::from).collect()
            }
        };
        Ok(Indexed {
            positions: &vectors(self.position),
            normals: &self.normal.map(vectors).unwrap_or_default(),
            indices: &indices,
        }
        .mesh()?)
    }
}

fn read(
    what: &'static str,
    slice: wgpu::BufferSlice,
    device: &wgpu::Device,
    queue: &wgpu::Queue,
) -> Result<Vec<u8>, GpuMeshError> {
    let (buffer, offset, size) = (slice.buffer(), slice.offset(), slice.size());
    if !buffer.usage().contains(wgpu::BufferUsages::COPY_SRC) {
        return Err(GpuMeshError::Usage(what));
    }
    let copied = size.next_multiple_of(wgpu::COPY_BUFFER_ALIGNMENT);
    let is_aligned = offset.is_multiple_of(wgpu::COPY_BUFFER_ALIGNMENT);
    if !is_aligned || offset + copied > buffer.size() {
        return Err(GpuMeshError::Alignment(what));
    }
    let staging = device.create_buffer(&wgpu::BufferDescriptor {
        label: Some(what),
        size: copied,
        usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
        mapped_at_creation: false,
    });
    let mut encoder = device.create_command_encoder(&Default::default());
    encoder.copy_buffer_to_buffer(buffer, offset, &staging, 0, copied);
    queue.submit([encoder.finish()]);
    let (sender, receiver) = mpsc::channel();
    staging.map_async(wgpu::MapMode::Read, .., move |done| {
        let _ = sender.send(done); // nobody waits any more after an error below
    });
    let failed = |why: String| GpuMeshError::Device { what, why };
    let waited = device.poll(wgpu::PollType::wait_indefinitely());
    waited.map_err(|error| failed(error.to_string()))?;
    let done = receiver.recv().map_err(|error| failed(error.to_string()))?;
    done.map_err(|error| failed(error.to_string()))?;
    let mapped = staging.slice(..size).get_mapped_range();
    let mapped = mapped.map_err(|error| failed(error.to_string()))?;
    Ok(mapped.to_vec())
}
