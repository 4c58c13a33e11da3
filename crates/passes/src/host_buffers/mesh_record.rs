//! A host's vertices as kernels read them.

use super::layout::HostVertices;

/// Items that a workgroup of a kernel writes at once.
const WIDTH: u32 = 256;
/// The most workgroups of a dispatch along an axis.
pub(super) const MOST_GROUPS: u32 = 65535;

/// As `Mesh` in place.wgsl.
#[repr(C)]
#[derive(Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
pub(super) struct MeshRecord {
    first: u32,
    stride: u32,
    position_at: u32,
    position_format: u32,
    normal_at: u32,
    normal_format: u32,
    positions: u32,
    normals: u32,
}

impl MeshRecord {
    /// Describes vertices that begin at a byte of the bound range.
    pub fn new(vertices: &HostVertices, first: u64, [positions, normals]: [u32; 2]) -> Self {
        let words = |bytes: u64| (bytes / 4) as u32;
        let normal = vertices.normal.unwrap_or(vertices.position);
        Self {
            first: words(first),
            stride: words(vertices.stride),
            position_at: words(vertices.position.at),
            position_format: vertices.position.code(),
            normal_at: words(normal.at),
            normal_format: normal.code(),
            positions,
            normals,
        }
    }
}

/// Workgroups for so many items.
pub(super) fn across_items(items: u32) -> u32 {
    items.div_ceil(WIDTH).min(MOST_GROUPS)
}
