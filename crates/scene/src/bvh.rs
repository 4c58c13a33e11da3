//! A binary bounding volume hierarchy over a mesh's triangles, built by obvhs (PLOC with reinsertion).

use crate::Mesh;
use obvhs::{BvhBuildParams, bvh2::builder::build_bvh2_from_tris, triangle::Triangle};
use std::time::Duration;

/// One node, 32 bytes, laid out as the trace shader reads it.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BvhNode {
    /// Low corner of the node's box.
    pub min: [f32; 3],
    /// Inner node: index of the first child, the second follows it. Leaf: first slot in [`Bvh::primitives`].
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
    /// Builds the hierarchy with all cores. Boxes contain their triangles exactly (f32 min and max of f32 corners).
    pub fn build(mesh: &Mesh) -> Self {
        let triangles: Vec<Triangle> = mesh
            .triangles
            .iter()
            .map(|indices| {
                let [v0, v1, v2] = indices.map(|index| mesh.positions[index as usize].into());
                Triangle { v0, v1, v2 }
            })
            .collect();
        if triangles.is_empty() {
            return Self::default();
        }
        // Triangles stay whole (no spatial splits): a split primitive would be tested, and counted, more than once.
        let params = BvhBuildParams {
            pre_split: false,
            ..BvhBuildParams::slow_build()
        };
        let tree = build_bvh2_from_tris(&triangles, params, &mut Duration::default());
        let nodes: Vec<BvhNode> = tree
            .nodes
            .iter()
            .map(|node| BvhNode {
                min: node.aabb.min.into(),
                first: node.first_index,
                max: node.aabb.max.into(),
                count: node.prim_count,
            })
            .collect();
        let depth = depth(&nodes);
        Self {
            nodes,
            primitives: tree.primitive_indices,
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
