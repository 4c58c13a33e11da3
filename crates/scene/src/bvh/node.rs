//! Nodes of the hierarchy.

/// Leaves hold at most this many triangles.
pub(super) const MAX_LEAF: u32 = 8;

/// One node, 32 bytes, laid out as the trace shader reads it.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct BvhNode {
    /// Low corner of the node's box.
    pub min: [f32; 3],
    /// Inner node: index of the first child, the second follows it. Leaf: first slot in
    /// [`Bvh::primitives`](super::Bvh::primitives).
    pub first: u32,
    /// High corner of the node's box.
    pub max: [f32; 3],
    /// Number of primitives of a leaf; 0 marks an inner node.
    pub count: u32,
}
