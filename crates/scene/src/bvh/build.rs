//! Building: clusters of boxes, then parallel reinsertion by obvhs (Meister and Bittner 2018).

use super::node::{BvhNode, MAX_DEPTH, MAX_LEAF, depth};
use super::ploc::cluster;
use super::top::{Split, over_boxes};
use glam::Vec3A;
use obvhs::{
    aabb::Aabb,
    bvh2::{Bvh2, leaf_collapser::collapse, node::Bvh2Node, reinsertion::ReinsertionOptimizer},
};
#[cfg(feature = "rayon")]
use std::sync::LazyLock;

/// Where half the surface of the scene's box overflows, the surface area heuristic has nothing to
/// compare; nor has it of no box.
pub(super) fn measurable(count: u32, box_of: impl Fn(u32) -> Aabb) -> bool {
    let empty = Aabb::empty();
    let bounds = (0..count).fold(empty, |sum, id| sum.union(&box_of(id)));
    count > 0 && bounds.half_area().is_finite()
}

/// Work that a tree is worth. What rays cost grows by 2 to 8 % from the first to the second, and
/// half of the time is left.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Effort {
    /// For a tree that lasts.
    Thorough,
    /// For a tree that is built in a frame, or that few rays walk.
    Quick,
}

/// More triangles than this are built in pieces: a tree of ten million took 43 s of two cores and
/// 2.9 GB as a whole, 17 s and 1.3 GB in pieces, and rays cost 0.98 of that. Of fewer, such as
/// Sponza's 262,267, rays would cost 1.09.
const MOST_WHOLE: usize = 1 << 19;
/// Most triangles of a piece.
const PIECE: u32 = 1 << 18;
/// Share of the nodes of all pieces together, the largest, for which a better place is sought.
const JOINED: f32 = 0.02;

/// Does what obvhs's `slow_build` does, with changes. Triangles stay whole (no spatial splits): a
/// split one would be tested, and counted, more than once. Leaves are smaller: on Sponza's shadow
/// rays a traversal cost of 1.5 instead of 3 halves the triangle tests (8.0 → 4.2 per ray) for 5 %
/// more box tests (64.5 → 67.6), and a watertight triangle test costs several boxes. Every second
/// step of the reinsertion is left out: two thirds of the time for 0.1 to 1 % of the cost. And it
/// gives up, `None`, where the tree becomes deeper than [`MAX_DEPTH`].
///
/// `box_of` returns the box of each triangle below `count`.
pub(super) fn ploc(count: u32, box_of: impl Fn(u32) -> Aabb, effort: Effort) -> Option<Bvh2> {
    if count as usize > MOST_WHOLE {
        return in_pieces(count, box_of, effort);
    }
    whole(&(0..count).map(box_of).collect::<Vec<_>>(), effort)
}

/// Builds a tree whose depth is the logarithm of the number of boxes. Returns its nodes, and the
/// boxes' numbers in the order of the leaves, each of which has at most `most`.
pub(super) fn in_halves(
    count: u32,
    box_of: impl Fn(u32) -> Aabb,
    most: u32,
) -> (Vec<BvhNode>, Vec<u32>) {
    let boxes = (0..count).map(box_of).map(|aabb| BvhNode {
        min: aabb.min.into(),
        max: aabb.max.into(),
        ..BvhNode::default()
    });
    over_boxes(&boxes.collect::<Vec<_>>(), Split::ByCount, most)
}

/// Halves the triangles until they are few enough for a tree each, whose largest nodes then find
/// better places in the tree of all.
fn in_pieces(count: u32, box_of: impl Fn(u32) -> Aabb, effort: Effort) -> Option<Bvh2> {
    let (top, ids) = in_halves(count, &box_of, PIECE);
    let mut tree = Bvh2::default();
    let inner = |node: &BvhNode| {
        let aabb = Aabb::new(Vec3A::from(node.min), Vec3A::from(node.max));
        Bvh2Node::new(aabb, 0, node.first)
    };
    tree.nodes = top.iter().map(inner).collect();
    for (slot, leaf) in top.iter().enumerate().filter(|(_, node)| node.count > 0) {
        let ids = &ids[leaf.first as usize..][..leaf.count as usize];
        let boxes: Vec<Aabb> = ids.iter().map(|&id| box_of(id)).collect();
        let piece = whole(&boxes, effort)?;
        let nodes = tree.nodes.len() as u32 - 1;
        let slots = tree.primitive_indices.len() as u32;
        let mut moved = piece.nodes.iter().map(|node| {
            let by = if node.is_leaf() { slots } else { nodes };
            Bvh2Node::new(node.aabb, node.prim_count, node.first_index + by)
        });
        tree.nodes[slot] = moved.next()?;
        tree.nodes.extend(moved);
        let primitives = piece.primitive_indices.iter();
        tree.primitive_indices
            .extend(primitives.map(|&place| ids[place as usize]));
    }
    tree.max_depth = 4 * MAX_DEPTH as usize;
    let steps = STEPS.map(|step| 1.0 / f32::from(step));
    ReinsertionOptimizer::default().run(&mut tree, JOINED, Some(steps.to_vec()));
    Some(tree)
}

fn whole(boxes: &[Aabb], effort: Effort) -> Option<Bvh2> {
    #[cfg(feature = "rayon")]
    if boxes.len() < FEW
        && let Some(alone) = &*ALONE
    {
        return alone.install(|| on_these_threads(boxes, effort));
    }
    on_these_threads(boxes, effort)
}

/// Trees of fewer triangles are built by one thread: a part that is added to a scene is built in a
/// frame, and with other work beside it, each of the many steps would wait for the other threads
/// to be woken.
#[cfg(feature = "rayon")]
const FEW: usize = 8192;

/// A pool of one thread; none where the system gives no thread.
#[cfg(feature = "rayon")]
static ALONE: LazyLock<Option<rayon::ThreadPool>> = LazyLock::new(|| {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1);
    pool.build().ok()
});

/// Each step of the reinsertion takes one in so many of the nodes of its share.
const STEPS: [u8; 8] = [1, 5, 9, 13, 17, 21, 25, 29];

fn on_these_threads(boxes: &[Aabb], effort: Effort) -> Option<Bvh2> {
    let (reach, shares) = match effort {
        Effort::Thorough => (24, [0.2, 0.4]),
        Effort::Quick => (14, [0.05, 0.1]),
    };
    let mut tree = cluster(boxes, reach);
    let mut optimizer = ReinsertionOptimizer::default();
    let link = |node: &Bvh2Node| (node.first_index, node.prim_count);
    // The stack of a search holds twice as many: a step makes the tree a few times as deep at most.
    tree.max_depth = 4 * MAX_DEPTH as usize;
    for (is_first, share) in [(true, shares[0]), (false, shares[1])] {
        if !is_first {
            collapse(&mut tree, MAX_LEAF, 1.5);
        }
        // Each costs the number of nodes times the depth, which grows from step to step on a fan of
        // many triangles, say.
        for step in STEPS {
            if depth(|index| link(&tree.nodes[index as usize])) > MAX_DEPTH {
                return None;
            }
            optimizer.run(&mut tree, share, Some(vec![1.0 / f32::from(step)]));
        }
    }
    Some(tree)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        bvh::tree::{Bvh, triangle_box},
        generate::Generator,
    };

    fn cost(tree: Option<Bvh2>) -> f64 {
        Bvh::of(tree.unwrap()).cost()
    }

    #[test]
    fn rays_cost_no_more_in_pieces_and_little_more_in_quick_trees() {
        for scene in ["city:540000", "forest:540000"] {
            let mesh = scene.parse::<Generator>().unwrap().build();
            let count = mesh.triangles.len() as u32;
            assert!(count as usize > MOST_WHOLE);
            let box_of = |id: u32| {
                let corners = mesh.triangles[id as usize];
                triangle_box(corners.map(|index| mesh.positions[index as usize]))
            };
            let boxes: Vec<Aabb> = (0..count).map(box_of).collect();
            let costs = [Effort::Thorough, Effort::Quick].map(|effort| {
                let pieces = cost(ploc(count, box_of, effort));
                (cost(whole(&boxes, effort)), pieces)
            });
            let [(thorough, pieces), (quick, quick_pieces)] = costs;
            assert!(pieces <= 1.03 * thorough, "{scene}: {costs:?}");
            assert!(
                quick.max(quick_pieces) <= 1.1 * thorough,
                "{scene}: {costs:?}"
            );
        }
    }
}
