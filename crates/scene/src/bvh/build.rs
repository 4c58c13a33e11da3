//! Building by obvhs: PLOC (Meister and Bittner 2018) with parallel reinsertion (Meister and
//! Bittner 2018).

use super::node::MAX_LEAF;
use glam::Vec3;
use obvhs::{
    BvhBuildParams,
    bvh2::{Bvh2, leaf_collapser::collapse, reinsertion::ReinsertionOptimizer},
    ploc::PlocBuilder,
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

/// obvhs's `slow_build` with two changes. Triangles stay whole (no spatial splits): a split one
/// would be tested, and counted, more than once. And leaves are smaller: on Sponza's shadow rays a
/// traversal cost of 1.5 instead of 3 halves the triangle tests (8.0 → 4.2 per ray) for 5 % more
/// box tests (64.5 → 67.6), and a watertight triangle test costs several boxes. The faster presets
/// build in a third of the time for as many boxes; half a second for Sponza on two cores is little
/// beside its import.
pub(super) fn ploc(triangles: &[Triangle]) -> Bvh2 {
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

fn on_these_threads(triangles: &[Triangle]) -> Bvh2 {
    let params = BvhBuildParams {
        collapse_traversal_cost: 1.5,
        ..BvhBuildParams::slow_build()
    };
    // The steps of obvhs's own `build_bvh2`, which would validate the tree by panicking in debug
    // builds.
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
