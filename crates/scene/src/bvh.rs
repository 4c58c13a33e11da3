//! A binary bounding volume hierarchy over a mesh's triangles, built by obvhs: PLOC (Meister and Bittner 2018) with
//! parallel reinsertion (Meister and Bittner 2018).

use crate::Mesh;
use obvhs::{
    BvhBuildParams,
    bvh2::{Bvh2, leaf_collapser::collapse, reinsertion::ReinsertionOptimizer},
    ploc::PlocBuilder,
    triangle::Triangle,
};

/// No tree is deeper, whatever the mesh: a traversal's stack of this many entries never overflows.
/// Real scenes stay below 45 (Sponza: 38).
pub const MAX_DEPTH: u32 = 64;

/// Leaves hold at most this many triangles.
const MAX_LEAF: u32 = 8;

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
    /// Builds the hierarchy with all cores; the same mesh always gives the same tree. Boxes contain their triangles
    /// exactly (f32 min and max of f32 corners).
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
        // Where half the surface of the scene's box overflows, the surface area heuristic has nothing to compare.
        let measurable = mesh.bounds().is_some_and(|(min, max)| {
            let size = max - min;
            (size.x * size.y + size.y * size.z + size.z * size.x).is_finite()
        });
        let ploc = measurable.then(|| Self::from_obvhs(ploc(&triangles)));
        match ploc {
            Some(bvh) if bvh.depth <= MAX_DEPTH => bvh,
            _ => median::build(&triangles),
        }
    }

    fn from_obvhs(tree: Bvh2) -> Self {
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

/// obvhs's `slow_build` with two changes. Triangles stay whole (no spatial splits): a split one would be tested, and
/// counted, more than once. And leaves are smaller: on Sponza's shadow rays a traversal cost of 1.5 instead of 3 halves the
/// triangle tests (8.0 → 4.2 per ray) for 5 % more box tests (64.5 → 67.6), and a watertight triangle test costs several boxes.
/// The faster presets build in a third of the time for as many boxes; half a second for Sponza on two cores is little beside its import.
fn ploc(triangles: &[Triangle]) -> Bvh2 {
    let params = BvhBuildParams {
        collapse_traversal_cost: 1.5,
        ..BvhBuildParams::slow_build()
    };
    // The steps of obvhs's own `build_bvh2`, which would validate the tree by panicking in debug builds.
    let indices = (0..triangles.len() as u32).collect();
    let mut tree = PlocBuilder::with_capacity(triangles.len()).build(
        params.ploc_search_distance,
        triangles,
        indices,
        params.sort_precision,
        params.search_depth_threshold,
    );
    let mut optimizer = ReinsertionOptimizer::default();
    optimizer.run(&mut tree, params.reinsertion_batch_ratio, None);
    collapse(&mut tree, MAX_LEAF, params.collapse_traversal_cost);
    let again =
        params.reinsertion_batch_ratio * params.post_collapse_reinsertion_batch_ratio_multiplier;
    optimizer.run(&mut tree, again, None);
    tree
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

/// The tree of last resort: split in two equal halves along the longest axis of the centres. Its depth is the logarithm
/// of the number of triangles. Meshes need it whose triangles grow geometrically (PLOC chains them) or span the range of f32.
mod median {
    use super::{Bvh, BvhNode, MAX_LEAF, Triangle, depth};
    use glam::{DVec3, Vec3};

    pub fn build(triangles: &[Triangle]) -> Bvh {
        let corners = |id: u32| {
            let triangle = &triangles[id as usize];
            [triangle.v0, triangle.v1, triangle.v2].map(Vec3::from)
        };
        let centre = |id: u32| corners(id).map(Vec3::as_dvec3).iter().sum::<DVec3>();
        let mut primitives: Vec<u32> = (0..triangles.len() as u32).collect();
        let mut nodes = vec![BvhNode {
            min: [0.0; 3],
            first: 0,
            max: [0.0; 3],
            count: 0,
        }];
        let mut open = vec![(0, 0..primitives.len())];
        while let Some((slot, range)) = open.pop() {
            let ids = &mut primitives[range.clone()];
            let (min, max) = ids
                .iter()
                .flat_map(|&id| corners(id))
                .fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(min, max), p| {
                    (min.min(p), max.max(p))
                });
            let mut node = BvhNode {
                min: min.into(),
                first: range.start as u32,
                max: max.into(),
                count: range.len() as u32,
            };
            if node.count > MAX_LEAF {
                let (low, high) = ids
                    .iter()
                    .map(|&id| centre(id))
                    .fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), p| {
                        (low.min(p), high.max(p))
                    });
                let axis = (high - low).max_position();
                let half = ids.len() / 2;
                // Ids break ties, so that the order is the same in every build.
                ids.select_nth_unstable_by(half, |&a, &b| {
                    centre(a)[axis].total_cmp(&centre(b)[axis]).then(a.cmp(&b))
                });
                node.first = nodes.len() as u32;
                node.count = 0;
                nodes.extend([node; 2]);
                let (start, middle, first) = (range.start, range.start + half, node.first as usize);
                open.push((first, start..middle));
                open.push((first + 1, middle..range.end));
            }
            nodes[slot] = node;
        }
        let depth = depth(&nodes);
        Bvh {
            nodes,
            primitives,
            depth,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    #[test]
    fn some_meshes_do_need_the_tree_of_last_resort() {
        // Each triangle 1.5 times as large as the one before, from one corner: PLOC joins the two smallest, then the next …
        let triangles: Vec<Triangle> = (0..200)
            .map(|i| 1.5f32.powi(i - 120))
            .map(|size| Triangle {
                v0: Vec3::ZERO.into(),
                v1: Vec3::new(size, size, 0.0).into(),
                v2: Vec3::new(0.0, size, size).into(),
            })
            .collect();
        assert!(Bvh::from_obvhs(ploc(&triangles)).depth > MAX_DEPTH);
        assert!(median::build(&triangles).depth < 8);
    }
}
