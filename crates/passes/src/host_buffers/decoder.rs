//! A module of the host that decodes vertices of formats that are not ours.

use super::{
    error::HostMeshError,
    layout::HostVertices,
    writes::{Made, MeshRecord, across_items},
};
use crate::{
    buffers::{On, refused},
    host,
};
use std::sync::Arc;
use wgpu::util::{BufferInitDescriptor, DeviceExt};

/// Normals of a module that has none: triangles get those of their planes.
const NO_NORMALS: &str = "fn decode_normal(first: u32) -> vec3<f32> { return vec3(0.0); }";

/// WGSL module of the host that decodes vertices, in the place of ours
/// ([`HostVertices::with_decoder`]).
///
/// It has the function `decode_position(first: u32) -> vec3<f32>`, and
/// `decode_normal(first: u32) -> vec3<f32>` where it decodes normals, of any length. `first` is the
/// number of the vertex's first word in `vertices: array<u32>`, the host's buffer in words of four
/// bytes, which the module does not declare. Its other names begin with `decode_`.
///
/// Positions are equal in all kernels where the module computes them in integers, or in f32 without
/// rounding. A module that rounds may differ between kernels by what a compiler fuses: bounds are
/// then [stated](crate::HostMesh::with_bounds) so much larger.
#[derive(Clone, Debug)]
pub struct HostDecoder {
    pub(super) made: Arc<Made>,
    pub(super) has_normals: bool,
}

impl HostDecoder {
    /// Compiles a module that decodes positions. Triangles have the normals of their planes.
    ///
    /// # Errors
    /// [`HostMeshError::Module`] with the line that is wrong.
    pub fn of_positions(device: &wgpu::Device, wgsl: &str) -> Result<Self, HostMeshError> {
        let needed = "`decode_position(first: u32) -> vec3<f32>`";
        Self::new(device, &format!("{wgsl}\n{NO_NORMALS}"), needed, false)
    }

    /// Compiles a module that decodes positions and normals.
    ///
    /// # Errors
    /// [`HostMeshError::Module`] with the line that is wrong.
    pub fn of_positions_and_normals(
        device: &wgpu::Device,
        wgsl: &str,
    ) -> Result<Self, HostMeshError> {
        let needed = "`decode_position` and `decode_normal`, both `(first: u32) -> vec3<f32>`";
        Self::new(device, wgsl, needed, true)
    }

    fn new(
        device: &wgpu::Device,
        wgsl: &str,
        needed: &'static str,
        has_normals: bool,
    ) -> Result<Self, HostMeshError> {
        // The host's module comes first, so that lines are those of its text.
        let decode = format!("{wgsl}\n{}", include_str!("host_decode.wgsl"));
        let made = refused(device, || Made::new(device, &decode));
        let made = made.map_err(|why| HostMeshError::Module { needed, why })?;
        Ok(Self {
            made: Arc::new(made),
            has_normals,
        })
    }

    /// Decodes positions and normals of all vertices at rest, whose bytes these are, and waits for
    /// them; no normals if the module has none.
    pub(super) fn decoded(
        &self,
        vertices: &HostVertices,
        rest: &[u8],
        on: On,
    ) -> Result<[Vec<[f32; 3]>; 2], HostMeshError> {
        if vertices.count == 0 {
            return Ok(Default::default());
        }
        let found = refused(on.device, || self.at_rest(vertices, rest, on));
        let found = found.map_err(HostMeshError::Decoding)?;
        let found = host::read("vertices at rest", found.slice(..), on.device, on.queue);
        let found = found.map_err(|error| HostMeshError::Decoding(error.to_string()))?;
        let found: Vec<[[f32; 3]; 2]> = bytemuck::pod_collect_to_vec(&found);
        let of = |at: usize| found.iter().map(|vertex| vertex[at]).collect();
        let normals = if self.has_normals { of(1) } else { Vec::new() };
        Ok([of(0), normals])
    }

    /// Submits the kernel that decodes vertices; the buffer that it writes.
    fn at_rest(&self, vertices: &HostVertices, rest: &[u8], on: On) -> wgpu::Buffer {
        let device = on.device;
        let upload = |contents: &[u8], usage| {
            let label = Some("vertices at rest");
            device.create_buffer_init(&BufferInitDescriptor {
                label,
                contents,
                usage,
            })
        };
        let record = MeshRecord::new(vertices, 0, [vertices.count, 0]);
        let bytes = &rest[..vertices.length() as usize];
        let inputs = [
            upload(bytemuck::bytes_of(&record), wgpu::BufferUsages::UNIFORM),
            upload(bytes, wgpu::BufferUsages::STORAGE),
        ];
        let found = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("decoded vertices"),
            size: 24 * u64::from(vertices.count),
            usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC,
            mapped_at_creation: false,
        });
        let pipeline = self.made.compile("decode_rest", device);
        let bound = [(0, &inputs[0]), (2, &inputs[1]), (13, &found)];
        let entries = bound.map(|(binding, buffer)| wgpu::BindGroupEntry {
            binding,
            resource: buffer.as_entire_binding(),
        });
        let group = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("vertices at rest"),
            layout: &pipeline.get_bind_group_layout(0),
            entries: &entries,
        });
        let mut encoder = device.create_command_encoder(&Default::default());
        {
            let mut pass = encoder.begin_compute_pass(&Default::default());
            pass.set_pipeline(&pipeline);
            pass.set_bind_group(0, &group, &[]);
            pass.dispatch_workgroups(across_items(vertices.count), 1, 1);
        }
        on.queue.submit([encoder.finish()]);
        found
    }
}
