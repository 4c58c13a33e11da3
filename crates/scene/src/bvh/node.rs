//! Nodes of the hierarchy.

/// Leaves hold at most this many triangles.
pub(super) const MAX_LEAF: u32 = 8;

/// Node of a [`Bvh`](super::Bvh): 32 bytes, laid out as the trace shader reads it.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct BvhNode {
    /// Low corner of the node's box.
    pub min: [f32; 3],
    /// Index of a child or a slot. For an inner node it is the first child, which the second child
    /// follows. For a leaf it is the first slot in [`Bvh::primitives`](super::Bvh::primitives).
    pub first: u32,
    /// High corner of the node's box.
    pub max: [f32; 3],
    /// Number of primitives of a leaf; 0 marks an inner node.
    pub count: u32,
}
