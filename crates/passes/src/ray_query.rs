//! The scene as an acceleration structure of the device: one geometry, one instance.

use crate::error::Error;
use skiagraph_scene::Mesh;

/// Rows of the matrix that leaves everything where it is.
const IDENTITY: [f32; 12] = [1., 0., 0., 0., 0., 1., 0., 0., 0., 0., 1., 0.];

/// Builds it of the buffers of the mesh's positions (16 bytes each) and indices (4 bytes each), and
/// submits the build. Primitives count as in the mesh, and none is opaque: a query sees each as a
/// candidate. A mesh without triangles is a structure without instances.
///
/// # Errors
/// More triangles than the device can take, or an index beyond the mesh's positions.
pub(crate) fn build(
    mesh: &Mesh,
    [vertices, indices]: [&wgpu::Buffer; 2],
    device: &wgpu::Device,
    queue: &wgpu::Queue,
) -> Result<wgpu::Tlas, Error> {
    let most = device.limits().max_blas_primitive_count;
    if mesh.triangles.len() as u64 > u64::from(most) {
        return Err(Error::TooManyTriangles {
            triangles: mesh.triangles.len(),
            most,
        });
    }
    check_corners(mesh)?;
    let corners = mesh.positions.len();
    let size = wgpu::BlasTriangleGeometrySizeDescriptor {
        vertex_format: wgpu::VertexFormat::Float32x3,
        vertex_count: corners as u32,
        index_format: Some(wgpu::IndexFormat::Uint32),
        index_count: Some(3 * mesh.triangles.len() as u32),
        flags: wgpu::AccelerationStructureGeometryFlags::empty(),
    };
    let mut tlas = device.create_tlas(&wgpu::CreateTlasDescriptor {
        label: Some("scene.tlas"),
        max_instances: 1,
        flags: wgpu::AccelerationStructureFlags::PREFER_FAST_TRACE,
        update_mode: wgpu::AccelerationStructureUpdateMode::Build,
    });
    let blas = (!mesh.triangles.is_empty()).then(|| {
        device.create_blas(
            &wgpu::CreateBlasDescriptor {
                label: Some("scene.blas"),
                flags: wgpu::AccelerationStructureFlags::PREFER_FAST_TRACE,
                update_mode: wgpu::AccelerationStructureUpdateMode::Build,
            },
            wgpu::BlasGeometrySizeDescriptors::Triangles {
                descriptors: vec![size.clone()],
            },
        )
    });
    tlas[0] = blas
        .as_ref()
        .map(|blas| wgpu::TlasInstance::new(blas, IDENTITY, 0, u8::MAX));
    let geometry = || wgpu::BlasTriangleGeometry {
        size: &size,
        vertex_buffer: vertices,
        first_vertex: 0,
        vertex_stride: 16,
        index_buffer: Some(indices),
        first_index: Some(0),
        transform_buffer: None,
        transform_buffer_offset: None,
    };
    let entry = blas.as_ref().map(|blas| wgpu::BlasBuildEntry {
        blas,
        geometry: wgpu::BlasGeometries::TriangleGeometries(vec![geometry()]),
    });
    let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor {
        label: Some("scene.tlas"),
    });
    encoder.build_acceleration_structures(entry.iter(), [&tlas]);
    queue.submit([encoder.finish()]);
    Ok(tlas)
}

/// Refuses a mesh whose triangles have corners that it lacks. Builders of hierarchies do not look
/// at indices, and the memory behind the positions may belong to anything.
pub(crate) fn check_corners(mesh: &Mesh) -> Result<(), Error> {
    let corners = mesh.positions.len();
    let mut used = mesh.triangles.as_flattened().iter();
    match used.find(|index| **index as usize >= corners) {
        Some(&index) => Err(Error::Corner { index, corners }),
        None => Ok(()),
    }
}
