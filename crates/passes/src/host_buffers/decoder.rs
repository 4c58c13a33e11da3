//! A module of the host that decodes vertices of formats that are not ours.

use super::{error::HostMeshError, kernel_module::KernelModule};
use crate::buffers::refused;
use skiagraph_gpu::DeviceIdentity;
use std::sync::Arc;

/// Normals of a module that has none: triangles get those of their planes.
const NO_NORMALS: &str = "fn decode_normal(first: u32) -> vec3<f32> { return vec3(0.0); }";

/// WGSL module of the host that decodes vertices, in the place of the built-in formats
/// ([`HostVertices::with_decoder`](super::HostVertices::with_decoder)).
///
/// It has the function `decode_position(first: u32) -> vec3<f32>`, and
/// `decode_normal(first: u32) -> vec3<f32>` where it decodes normals, of any length. `first` is the
/// index of the vertex's first word in `vertices: array<u32>`, which the module does not declare:
/// the range of the host's buffer that holds the mesh's vertices, in words of four bytes. Other
/// names that the module declares begin with `decode_`.
///
/// Positions are equal in all compute shaders that call the module where it computes them in
/// integers, or in f32 without rounding. A module that rounds may differ between them by what a
/// compiler fuses: the [stated](crate::HostMesh::with_bounds) bounds must then be larger by as
/// much.
#[derive(Clone, Debug)]
pub struct HostDecoder {
    pub(super) made: Arc<KernelModule>,
    pub(super) has_normals: bool,
    pub(super) device: DeviceIdentity,
}

impl HostDecoder {
    /// Compiles a module that decodes positions and has no `decode_normal`. Triangles have the
    /// normals of their planes.
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
        let made = refused(device, || KernelModule::new(device, &decode));
        let made = made.map_err(|why| HostMeshError::Module { needed, why })?;
        Ok(Self {
            made: Arc::new(made),
            has_normals,
            device: DeviceIdentity::new(device),
        })
    }
}
