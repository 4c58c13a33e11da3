//! Building: clusters of boxes, then parallel reinsertion by obvhs (Meister and Bittner 2018).

use super::{
    node::{MAX_DEPTH, MAX_LEAF, depth},
    ploc::cluster,
};
use glam::Vec3;
use obvhs::{
    aabb::Aabb,
    bvh2::{Bvh2, leaf_collapser::collapse, node::Bvh2Node, reinsertion::ReinsertionOptimizer},
    triangle::Triangle,
};
#[cfg(feature = "rayon")]
use std::sync::LazyLock;

/// Where half the surface of the scene's box overflows, the surface area heuristic has nothing to
/// compare; nor has it of no box.
pub(super) fn measurable(bounds: Option<(Vec3, Vec3)>) -> bool {
    bounds.is_some_and(|(min, max)| {
        let size = max - min;
        (size.x * size.y + size.y * size.z + size.z * size.x).is_finite()
    })
}

/// Does what obvhs's `slow_build` does, with three changes. Triangles stay whole (no spatial
/// splits): a split one would be tested, and counted, more than once. Leaves are smaller: on
/// Sponza's shadow rays a traversal cost of 1.5 instead of 3 halves the triangle tests (8.0 → 4.2
/// per ray) for 5 % more box tests (64.5 → 67.6), and a watertight triangle test costs several
/// boxes. And it gives up, `None`, where the tree becomes deeper than [`MAX_DEPTH`]. The faster
/// presets build in a third of the time for as many boxes; half a second for Sponza on two cores is
/// little beside its import.
pub(super) fn ploc(triangles: &[Triangle]) -> Option<Bvh2> {
    #[cfg(feature = "rayon")]
    if triangles.len() < FEW
        && let Some(alone) = &*ALONE
    {
        return alone.install(|| on_these_threads(triangles));
    }
    on_these_threads(triangles)
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

fn on_these_threads(triangles: &[Triangle]) -> Option<Bvh2> {
    let boxes: Vec<Aabb> = triangles.iter().map(Triangle::aabb).collect();
    let mut tree = cluster(&boxes);
    let mut optimizer = ReinsertionOptimizer::default();
    let link = |node: &Bvh2Node| (node.first_index, node.prim_count);
    // The stack of a search holds twice as many: a step makes the tree a few times as deep at most.
    tree.max_depth = 4 * MAX_DEPTH as usize;
    for (is_first, share) in [(true, 0.2), (false, 0.4)] {
        if !is_first {
            collapse(&mut tree, MAX_LEAF, 1.5);
        }
        // obvhs's own steps. Each costs the number of nodes times the depth, which grows from step
        // to step on a fan of many triangles, say.
        for step in (1u8..32).step_by(4) {
            if depth(|index| link(&tree.nodes[index as usize])) > MAX_DEPTH {
                return None;
            }
            let steps = [step, step + 2].map(|step| 1.0 / f32::from(step));
            optimizer.run(&mut tree, share, Some(steps.to_vec()));
        }
    }
    Some(tree)
}
