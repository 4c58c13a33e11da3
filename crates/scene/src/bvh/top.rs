//! Trees over boxes from the top down: the top level of a hierarchy, and the tree of last resort.
//! The top level is built in every frame in which one of its boxes moves, by the thread that asks
//! for it: waking others takes longer.

use super::node::{BvhNode, area};
use crate::mesh::bounds;
use glam::{DVec3, Vec3};

/// Number of places at which a node may be split along an axis, and one more (Wald, "On fast
/// construction of SAH-based bounding volume hierarchies", RT 2007).
const BINS: usize = 16;

/// Way in which the boxes of a node are split in two.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Split {
    /// Where rays are cheapest, by the surface area heuristic.
    ByArea,
    /// Into halves: the depth is the logarithm of the number of boxes.
    ByCount,
}

/// Builds a tree over at least one box, with at most `most` of them in a leaf. Returns its nodes,
/// and the numbers of the boxes in the order of the leaves.
pub(super) fn over_boxes(boxes: &[BvhNode], split: Split, most: u32) -> (Vec<BvhNode>, Vec<u32>) {
    let centres = boxes.iter().map(|node| {
        let [low, high] = [node.min, node.max].map(|corner| Vec3::from(corner).as_dvec3());
        low + high
    });
    let centres: Vec<DVec3> = centres.collect();
    let mut ids: Vec<u32> = (0..boxes.len() as u32).collect();
    let mut nodes = vec![BvhNode::default()];
    let mut open = vec![(0, 0..ids.len())];
    while let Some((slot, range)) = open.pop() {
        let ids = &mut ids[range.clone()];
        let corners = ids.iter().map(|&id| &boxes[id as usize]);
        let corners = corners.flat_map(|node| [Vec3::from(node.min), Vec3::from(node.max)]);
        let (min, max) = bounds(corners).unwrap_or_default();
        let mut node = BvhNode {
            min: min.into(),
            first: range.start as u32,
            max: max.into(),
            count: range.len() as u32,
        };
        if node.count > most {
            let by_area = (split == Split::ByArea && ids.len() > 2)
                .then(|| by_area(ids, boxes, &centres))
                .flatten();
            let half = by_area.unwrap_or_else(|| by_count(ids, &centres));
            (node.first, node.count) = (nodes.len() as u32, 0);
            nodes.extend([node; 2]);
            let (start, middle, first) = (range.start, range.start + half, node.first as usize);
            open.push((first, start..middle));
            open.push((first + 1, middle..range.end));
        }
        nodes[slot] = node;
    }
    (nodes, ids)
}

/// The lowest and highest centre.
fn extent(ids: &[u32], centres: &[DVec3]) -> (DVec3, DVec3) {
    let far = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    let centres = ids.iter().map(|&id| centres[id as usize]);
    centres.fold(far, |(low, high), p| (low.min(p), high.max(p)))
}

/// Sorts the boxes into halves; the number of the first ones.
fn by_count(ids: &mut [u32], centres: &[DVec3]) -> usize {
    let (low, high) = extent(ids, centres);
    let axis = (high - low).max_position();
    let half = ids.len() / 2;
    let along = |id: u32| centres[id as usize][axis];
    // Numbers break ties, so that the order is the same in every build.
    ids.select_nth_unstable_by(half, |&a, &b| along(a).total_cmp(&along(b)).then(a.cmp(&b)));
    half
}

/// Boxes of a part of an axis: their bounds, and how many they are.
#[derive(Clone, Copy, Default)]
struct Bin {
    bounds: Option<BvhNode>,
    count: usize,
}

impl Bin {
    fn with(self, other: Self) -> Self {
        let joined = |a: BvhNode, b: BvhNode| BvhNode {
            min: Vec3::from(a.min).min(b.min.into()).into(),
            max: Vec3::from(a.max).max(b.max.into()).into(),
            ..a
        };
        Self {
            bounds: match (self.bounds, other.bounds) {
                (Some(a), Some(b)) => Some(joined(a, b)),
                (a, b) => a.or(b),
            },
            count: self.count + other.count,
        }
    }

    fn cost(&self) -> f64 {
        self.bounds.as_ref().map_or(0.0, area) * self.count as f64
    }
}

/// Sorts the boxes into those on the two sides of the cheapest split; the number of the first ones,
/// `None` if all centres are one.
fn by_area(ids: &mut [u32], boxes: &[BvhNode], centres: &[DVec3]) -> Option<usize> {
    let (low, high) = extent(ids, centres);
    let bins = BINS.min(ids.len());
    let bin_of = |id: u32, axis: usize| {
        let along = (centres[id as usize][axis] - low[axis]) / (high[axis] - low[axis]);
        ((along * bins as f64) as usize).min(bins - 1)
    };
    let mut best: Option<(f64, usize, usize)> = None;
    for axis in (0..3).filter(|&axis| high[axis] > low[axis]) {
        let mut filled = [Bin::default(); BINS];
        for &id in ids.iter() {
            let own = Bin {
                bounds: Some(boxes[id as usize]),
                count: 1,
            };
            let bin = &mut filled[bin_of(id, axis)];
            *bin = bin.with(own);
        }
        let mut above = [0.0; BINS];
        let mut right = Bin::default();
        for bin in (1..bins).rev() {
            right = right.with(filled[bin]);
            above[bin] = right.cost();
        }
        let mut left = Bin::default();
        for (bin, above) in above.iter().enumerate().take(bins).skip(1) {
            left = left.with(filled[bin - 1]);
            let cost = left.cost() + above;
            if best.is_none_or(|(least, ..)| cost < least) {
                best = Some((cost, axis, bin));
            }
        }
    }
    let (_, axis, bin) = best?;
    ids.sort_by_key(|&id| bin_of(id, axis) >= bin);
    Some(ids.partition_point(|&id| bin_of(id, axis) < bin))
}

/// The depth of a top level together with the trees that are its leaves.
pub(super) fn deepest((top, order): &(Vec<BvhNode>, Vec<u32>), depths: &[u32]) -> u32 {
    let mut deepest = 0;
    let mut open = vec![(0u32, 0u32)];
    while let Some((index, above)) = open.pop() {
        let node = top[index as usize];
        match node.count {
            0 => open.extend([(node.first, above + 1), (node.first + 1, above + 1)]),
            _ => deepest = deepest.max(above + depths[order[node.first as usize] as usize]),
        }
    }
    deepest
}
