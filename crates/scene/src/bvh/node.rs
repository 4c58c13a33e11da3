//! Nodes of the hierarchy.

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
