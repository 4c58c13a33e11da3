//! Nodes of the hierarchy.

use glam::Vec3;

/// Leaves hold at most this many triangles.
pub(super) const MAX_LEAF: u32 = 8;

/// Node of a [`Bvh`](super::Bvh): 32 bytes, laid out as `shaders/trace_rays.wgsl` reads it.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct BvhNode {
    /// Low corner of the node's box, world space.
    pub min: [f32; 3],
    /// Index of a child or a primitive. For an inner node it is the index of the first child in
    /// [`Bvh::nodes`](super::Bvh::nodes), which the second child follows. For a leaf it is the
    /// index of the leaf's first entry in [`Bvh::primitives`](super::Bvh::primitives).
    pub first: u32,
    /// High corner of the node's box, world space.
    pub max: [f32; 3],
    /// Number of primitives (triangles) of a leaf; 0 marks an inner node.
    pub count: u32,
}

/// Greatest depth of a [`Bvh`](super::Bvh) over any mesh: nodes on a path from the root to a leaf.
/// A traversal stack of this many entries never overflows. Real scenes stay below 45 (Sponza: 38).
pub const MAX_DEPTH: u32 = 64;

/// Number of nodes on the longest path from the root to a leaf. `link` returns the first child and
/// the number of primitives of a node.
pub(super) fn depth(link: impl Fn(u32) -> (u32, u32)) -> u32 {
    let mut deepest = 0;
    let mut open = vec![(0u32, 1u32)];
    while let Some((index, level)) = open.pop() {
        deepest = deepest.max(level);
        if let (first, 0) = link(index) {
            open.extend([(first, level + 1), (first + 1, level + 1)]);
        }
    }
    deepest
}

pub(super) fn area(node: &BvhNode) -> f64 {
    let size = Vec3::from(node.max).as_dvec3() - Vec3::from(node.min).as_dvec3();
    size.x * size.y + size.y * size.z + size.z * size.x
}
