//! Clusters boxes into a tree from the bottom up: PLOC (Meister and Bittner, "Parallel
//! locally-ordered clustering for bounding volume hierarchy construction", TVCG 24(3), 2018), with
//! the reach and the ties of obvhs. Where boxes are alike (coincident, evenly spaced, or each a
//! little larger than the last) hardly two of them choose each other, and passes without end would
//! merge one pair each: the pass after such a one merges every free pair of which one chose the
//! other, about half of all.

use glam::DVec3;
use obvhs::aabb::Aabb;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::node::Bvh2Node;
use obvhs::ploc::morton::morton_encode_u128_unorm;
#[cfg(feature = "rayon")]
use rayon::prelude::*;

/// Number of first passes, in which a box chooses from its next neighbours alone.
const NARROW: usize = 2;
/// A pass that merges less than this share of its boxes is followed by one that merges more. No
/// pass over Sponza, `bench` or a soup of triangles merges so little.
const FEW: usize = 32;
/// Marks a box that has been merged.
const MERGED: u32 = u32::MAX;

/// Builds a tree with one box in each leaf. A box chooses from `reach` neighbours on each side.
/// There is at least one box, and the box of all of them has a finite surface.
pub(super) fn cluster(boxes: &[Aabb], reach: usize) -> Bvh2 {
    let mut tree = Bvh2::zeroed(boxes.len());
    tree.primitive_indices = (0..boxes.len() as u32).collect();
    let mut open = in_morton_order(boxes);
    let mut free = tree.nodes.len();
    let (mut pass, mut is_stuck) = (0, false);
    while open.len() > 1 {
        let mut chosen = choices(&open, if pass < NARROW { 1 } else { reach });
        let before = open.len();
        for one in 0..before {
            let other = chosen[one] as usize;
            let is_free = |node: usize| chosen[node] != MERGED;
            if !(is_free(one) && is_free(other)) || !(is_stuck || chosen[other] == one as u32) {
                continue;
            }
            (chosen[one], chosen[other]) = (MERGED, MERGED);
            let [first, second] = [one.min(other), one.max(other)];
            let pair = [open[first], open[second]];
            free -= 2;
            tree.nodes[free..free + 2].copy_from_slice(&pair);
            let around = pair[0].aabb().union(pair[1].aabb());
            open[first] = Bvh2Node::new(around, 0, free as u32);
            open[second].set_invalid();
        }
        open.retain(Bvh2Node::valid);
        is_stuck = (before - open.len()) * FEW < before;
        pass += 1;
    }
    tree.nodes[0] = open[0];
    // Each pass makes the tree one level deeper at most.
    tree.max_depth = pass + 1;
    tree.children_are_ordered_after_parents = true;
    tree
}

/// Leaves along a curve on which neighbours are near each other.
fn in_morton_order(boxes: &[Aabb]) -> Vec<Bvh2Node> {
    let centre = |aabb: &Aabb| (aabb.min.as_dvec3() + aabb.max.as_dvec3()) * 0.5;
    let bounds = boxes.iter().fold(Aabb::empty(), |sum, one| sum.union(one));
    let (low, size) = (bounds.min.as_dvec3(), bounds.diagonal().as_dvec3());
    // Along an axis without extent every code is 0.
    let scale = DVec3::select(size.cmpgt(DVec3::ZERO), size.recip(), DVec3::ZERO);
    let code = |aabb: &Aabb| morton_encode_u128_unorm((centre(aabb) - low) * scale);
    let codes = boxes.iter().zip(0..).map(|(aabb, id)| (code(aabb), id));
    let mut codes: Vec<(u128, u32)> = codes.collect();
    #[cfg(feature = "rayon")]
    codes.par_sort_unstable();
    #[cfg(not(feature = "rayon"))]
    codes.sort_unstable();
    let leaf = |(_, id): (u128, u32)| Bvh2Node::new(boxes[id as usize], 1, id);
    codes.into_iter().map(leaf).collect()
}

/// The neighbour of each node with which it makes the smallest box; of several, the last.
fn choices(open: &[Bvh2Node], reach: usize) -> Vec<u32> {
    let choose = |one: usize| {
        let (own, mut best) = (open[one].aabb(), (f32::INFINITY, one));
        let low = one.saturating_sub(reach);
        let near = &open[low..(one + reach + 1).min(open.len())];
        for (other, node) in (low..).zip(near) {
            let area = own.union(node.aabb()).half_area();
            if other != one && area <= best.0 {
                best = (area, other);
            }
        }
        best.1 as u32
    };
    #[cfg(feature = "rayon")]
    let nodes = (0..open.len()).into_par_iter().with_min_len(1024);
    #[cfg(not(feature = "rayon"))]
    let nodes = 0..open.len();
    nodes.map(choose).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3A;

    /// One pass merges a few at least: without that, sheets take a pass for every second box, and
    /// the time grows with the square of their number.
    #[test]
    fn boxes_that_are_alike_take_few_passes() {
        const COUNT: u16 = 20_000;
        let sheet = |x: f32, y: f32, size: f32| {
            let corner = Vec3A::new(x, y, 0.0);
            Aabb::new(corner, corner + Vec3A::new(size, 0.0, size))
        };
        let kinds: [&dyn Fn(f32) -> Aabb; 6] = [
            &|_| sheet(1.0, 1.0, 4.0),
            &|index| sheet(0.0, index * 1e-4, 4.0),
            &|index| sheet(1e6, 1e6 + index * 1e-4, 4.0),
            &|index| sheet(1e6, 1e6 + index, 4.0),
            &|index| sheet(0.0, 0.0, 1.0 + index * 0.01),
            &|index| sheet(0.0, 0.0, 1.0005f32.powf(index)),
        ];
        for (kind, make) in kinds.iter().enumerate() {
            let boxes: Vec<Aabb> = (0..COUNT).map(|index| make(f32::from(index))).collect();
            let tree = cluster(&boxes, 24);
            assert!(
                tree.max_depth < 200,
                "kind {kind}: {} passes",
                tree.max_depth
            );
        }
    }
}
