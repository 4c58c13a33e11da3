//! The tree of last resort: split in two equal halves along the longest axis of the centres. Its
//! depth is the logarithm of the number of triangles. Meshes need it whose triangles grow
//! geometrically (PLOC chains them) or span the range of f32.

use super::node::{BvhNode, MAX_LEAF};
use crate::mesh::bounds;
use glam::{DVec3, Vec3};
use obvhs::triangle::Triangle;

/// Builds a tree of at least one triangle: nodes, and primitives in order.
pub(super) fn build(triangles: &[Triangle]) -> (Vec<BvhNode>, Vec<u32>) {
    let corners = |id: u32| {
        let triangle = &triangles[id as usize];
        [triangle.v0, triangle.v1, triangle.v2].map(Vec3::from)
    };
    let centre = |id: u32| corners(id).map(Vec3::as_dvec3).iter().sum::<DVec3>();
    let mut primitives: Vec<u32> = (0..triangles.len() as u32).collect();
    let mut nodes = vec![BvhNode::default()];
    let mut open = vec![(0, 0..primitives.len())];
    while let Some((slot, range)) = open.pop() {
        let ids = &mut primitives[range.clone()];
        let (min, max) = bounds(ids.iter().flat_map(|&id| corners(id))).unwrap_or_default();
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
    (nodes, primitives)
}
