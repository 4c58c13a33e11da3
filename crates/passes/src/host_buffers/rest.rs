//! Vertices at rest, decoded by a module of the host: once, while a mesh is loaded.

use super::decoder::HostDecoder;
use super::error::HostMeshError;
use super::layout::HostVertices;
use super::mesh_record::{MeshRecord, across_items};
use crate::buffers::{On, refused, upload};
use crate::host;

/// Decodes positions and normals of all vertices at rest, whose bytes these are, and waits for
/// them; no normals if the module has none.
pub(super) fn decoded(
    decoder: &HostDecoder,
    vertices: &HostVertices,
    rest: &[u8],
    on: On,
) -> Result<[Vec<[f32; 3]>; 2], HostMeshError> {
    let buffer = refused(on.device, || submitted(decoder, vertices, rest, on));
    let buffer = buffer.map_err(HostMeshError::Decoding)?;
    let bytes = host::read("vertices at rest", buffer.slice(..), on.device, on.queue);
    let bytes = bytes.map_err(|error| HostMeshError::Decoding(error.to_string()))?;
    let vertices: Vec<[[f32; 3]; 2]> = bytemuck::pod_collect_to_vec(&bytes);
    let attribute = |at: usize| vertices.iter().map(|vertex| vertex[at]).collect();
    let normals = decoder.has_normals.then(|| attribute(1));
    Ok([attribute(0), normals.unwrap_or_default()])
}

/// Submits the kernel that decodes vertices; the buffer that it writes.
fn submitted(decoder: &HostDecoder, vertices: &HostVertices, rest: &[u8], on: On) -> wgpu::Buffer {
    let device = on.device;
    let upload = |contents: &[u8], usage| upload(device, "vertices at rest", contents, usage);
    let record = MeshRecord::new(vertices, 0, [vertices.count, 0]);
    let bytes = &rest[..vertices.length() as usize];
    let inputs = [
        upload(bytemuck::bytes_of(&record), wgpu::BufferUsages::UNIFORM),
        upload(bytes, wgpu::BufferUsages::STORAGE),
    ];
    let decoded = device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("decoded vertices"),
        size: 24 * u64::from(vertices.count),
        usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC,
        mapped_at_creation: false,
    });
    let pipeline = decoder.made.compile("decode_rest", device);
    let bound = [(0, &inputs[0]), (2, &inputs[1]), (13, &decoded)];
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
    let mut pass = encoder.begin_compute_pass(&Default::default());
    pass.set_pipeline(&pipeline);
    pass.set_bind_group(0, &group, &[]);
    pass.dispatch_workgroups(across_items(vertices.count), 1, 1);
    drop(pass);
    on.queue.submit([encoder.finish()]);
    decoded
}
