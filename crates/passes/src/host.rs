//! Inputs of a preset from a host program's own resources.

use skiagraph_gpu::DeviceIdentity;
use skiagraph_scene::{Indexed, IndexedError, Mesh};
use std::{error::Error, sync::mpsc};
use wgpu::util::DownloadBuffer;

/// Triangle mesh in the vertex and index buffers of a host program, which [`GpuMesh::read`] copies
/// back to the CPU.
///
/// The CPU needs its positions: light space (the space of a shadow map) is fitted to them, and
/// hierarchies and adjacency are built from them. A mesh whose vertices stay in the host's buffer
/// is a [`HostMesh`](crate::HostMesh).
#[derive(Clone, Copy, Debug)]
pub struct GpuMesh<'a> {
    /// Vertices, each [`stride`](Self::stride) bytes after the one before, in a buffer with the
    /// usage `COPY_SRC`.
    pub vertices: wgpu::BufferSlice<'a>,
    /// Distance from the start of one vertex to the start of the next, in bytes.
    pub stride: usize,
    /// Offset of the position within a vertex, in bytes. It is three f32 in world space, or in the
    /// space of a part for [`Movable::joined`](skiagraph_scene::Movable::joined).
    pub position: usize,
    /// Offset of the normal within a vertex, in bytes; it is three f32. `None` if vertices have
    /// none; triangles then get the normals of their planes.
    pub normal: Option<usize>,
    /// Three indices into `vertices` for each triangle, counter-clockwise as seen from outside, in
    /// a buffer with the usage `COPY_SRC`.
    pub indices: wgpu::BufferSlice<'a>,
    /// Type of the indices: 16 or 32 bits.
    pub format: wgpu::IndexFormat,
}

/// Reason why [`GpuMesh::read`] failed.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum GpuMeshError {
    /// A buffer lacks the usage `COPY_SRC`. Holds the content of the buffer: `vertices` or
    /// `indices`.
    #[error("the buffer of {0} cannot be read: it needs the usage COPY_SRC")]
    Usage(&'static str),
    /// A buffer is of another device, or the device is lost. Holds the content of the buffer:
    /// `vertices` or `indices`.
    #[error(
        "the buffer of {0} is of another device than the one that is to read it, or that is lost"
    )]
    OtherDevice(&'static str),
    /// A slice cannot be copied: its offset is not divisible by 4, or its size is not and the
    /// buffer ends before the next multiple. Holds the content of the buffer: `vertices` or
    /// `indices`.
    #[error("the {0} lie at an offset, or in a buffer, that is not divisible by 4")]
    Alignment(&'static str),
    /// A position or normal reaches beyond the end of its vertex.
    #[error("{what} at byte {at} does not fit a vertex of {stride} bytes")]
    Vertex {
        /// Attribute of the vertex: `position` or `normal`.
        what: &'static str,
        /// Offset of the attribute within a vertex, in bytes.
        at: usize,
        /// Size of a vertex in bytes.
        stride: usize,
    },
    /// The numbers in the buffers do not form a mesh, for example because an index lies beyond the
    /// last vertex.
    #[error(transparent)]
    Mesh(#[from] IndexedError),
    /// The device could not copy a buffer back.
    #[error("the {what} could not be read back: {why}")]
    Device {
        /// Content of the buffer: `vertices` or `indices`.
        what: &'static str,
        /// Reason that wgpu gives.
        #[source]
        why: Box<dyn Error + Send + Sync>,
    },
}

impl GpuMesh<'_> {
    /// Copies the buffers back from the GPU and makes a mesh of them, in which vertices of equal
    /// position share one position. Waits for the GPU, so call it when a mesh is loaded, not in
    /// each frame.
    ///
    /// # Errors
    /// [`GpuMeshError`] if a buffer cannot be read, or its numbers do not form a mesh.
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

pub(crate) fn read(
    what: &'static str,
    slice: wgpu::BufferSlice,
    device: &wgpu::Device,
    queue: &wgpu::Queue,
) -> Result<Vec<u8>, GpuMeshError> {
    let (buffer, offset, size) = (slice.buffer(), slice.offset(), slice.size());
    if !buffer.usage().contains(wgpu::BufferUsages::COPY_SRC) {
        return Err(GpuMeshError::Usage(what));
    }
    if !DeviceIdentity::new(device).has_buffer(buffer) {
        return Err(GpuMeshError::OtherDevice(what));
    }
    let copied = size.next_multiple_of(wgpu::COPY_BUFFER_ALIGNMENT);
    let is_aligned = offset.is_multiple_of(wgpu::COPY_BUFFER_ALIGNMENT);
    if !is_aligned || offset + copied > buffer.size() {
        return Err(GpuMeshError::Alignment(what));
    }
    let (sender, receiver) = mpsc::channel();
    let slice = buffer.slice(offset..offset + copied);
    DownloadBuffer::read_buffer(device, queue, &slice, move |done| {
        let _ = sender.send(done); // after an error below the receiver is gone
    });
    let failed = |why| GpuMeshError::Device { what, why };
    let waited = device.poll(wgpu::PollType::wait_indefinitely());
    waited.map_err(|error| failed(error.into()))?;
    let done = receiver.recv().map_err(|error| failed(error.into()))?;
    let bytes = done.map_err(|error| failed(error.into()))?;
    Ok(bytes[..size as usize].to_vec())
}
