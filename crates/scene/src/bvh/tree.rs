//! The hierarchy as shaders and tracers walk it.

/// No tree is deeper, whatever the mesh: a traversal's stack of this many entries never overflows.
/// Real scenes stay below 45 (Sponza: 38).
pub const MAX_DEPTH: u32 = 64;

/// Leaves hold at most this many triangles.
pub(super) const MAX_LEAF: u32 = 8;

/// One node, 32 bytes, laid out as the trace shader reads it.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BvhNode {
    /// Low corner of the node's box.
    pub min: [f32; 3],
    /// Inner node: index of the first child, the second follows it. Leaf: first slot in
    /// [`Bvh::primitives`].
    pub first: u32,
    /// High corner of the node's box.
    pub max: [f32; 3],
    /// Number of primitives of a leaf; 0 marks an inner node.
    pub count: u32,
}

/// The hierarchy. Node 0 is the root; an empty mesh has no nodes.
#[derive(Clone, Debug, Default)]
pub struct Bvh {
    /// Nodes, children in pairs.
    pub nodes: Vec<BvhNode>,
    /// Primitive ids in leaf order.
    pub primitives: Vec<u32>,
    /// Longest path from the root, in nodes: what a traversal's stack must hold.
    pub depth: u32,
}

impl Bvh {
    /// Creates a tree of nodes and primitives in order.
    pub(super) fn new(nodes: Vec<BvhNode>, primitives: Vec<u32>) -> Self {
        let depth = depth(&nodes);
        Self {
            nodes,
            primitives,
            depth,
        }
    }
}

fn depth(nodes: &[BvhNode]) -> u32 {
    let mut deepest = 0;
    let mut open = vec![(0u32, 1u32)];
    while let Some((index, level)) = open.pop() {
        deepest = deepest.max(level);
        let node = nodes[index as usize];
        if node.count == 0 {
            open.push((node.first, level + 1));
            open.push((node.first + 1, level + 1));
        }
    }
    deepest
}
