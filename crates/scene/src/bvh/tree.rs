//! The hierarchy as shaders and tracers walk it.

use super::build::{Effort, in_halves, measurable, ploc};
use super::node::{BvhNode, MAX_DEPTH, MAX_LEAF, area, depth};
use crate::mesh::{Mesh, bounds};
use glam::{Vec3, Vec3A};
use obvhs::{aabb::Aabb, bvh2::Bvh2};

/// Cost of a box beside a triangle: as where the tree is built.
const BOX: f64 = 1.5;

/// Binary bounding volume hierarchy over a mesh's triangles. Node 0 is the root; an empty mesh has
/// no nodes.
#[derive(Clone, Debug, Default)]
pub struct Bvh {
    /// Nodes of the tree, the root first. The two children of an inner node follow each other.
    pub nodes: Vec<BvhNode>,
    /// Primitive ids (indices into [`Mesh::triangles`]) in the order of the leaves, each once. Each
    /// leaf names a range of this list.
    pub primitives: Vec<u32>,
    /// Number of nodes on the longest path from the root to a leaf: the entries that a traversal's
    /// stack needs. 0 for an empty tree.
    pub depth: u32,
}

impl Bvh {
    /// Creates a tree of nodes and primitives in order.
    fn new(nodes: Vec<BvhNode>, primitives: Vec<u32>) -> Self {
        let link = |node: &BvhNode| (node.first, node.count);
        let depth = depth(|index| link(&nodes[index as usize]));
        Self {
            nodes,
            primitives,
            depth,
        }
    }

    /// Builds the hierarchy of a mesh, on all cores (with the feature `rayon`). The same mesh
    /// always gives the same tree. Boxes contain their triangles exactly (f32 minima and maxima of
    /// f32 corners).
    pub fn build(mesh: &Mesh) -> Self {
        Self::over_mesh(mesh, Effort::Thorough)
    }

    /// Builds the hierarchy of a mesh as [`build`](Self::build) does, in half of the time, for few
    /// rays: each costs 2 to 8 % more.
    pub fn build_quickly(mesh: &Mesh) -> Self {
        Self::over_mesh(mesh, Effort::Quick)
    }

    fn over_mesh(mesh: &Mesh, effort: Effort) -> Self {
        let ids: Vec<u32> = (0..mesh.triangles.len() as u32).collect();
        Self::over(mesh, &ids, MAX_DEPTH, effort)
    }

    /// Builds the hierarchy of some triangles of a mesh, whose places in the list are the primitive
    /// ids. It is no deeper than `depth` unless the logarithm of their number is.
    pub(super) fn over(mesh: &Mesh, ids: &[u32], depth: u32, effort: Effort) -> Self {
        let box_of = |place: u32| {
            let corners = mesh.triangles[ids[place as usize] as usize];
            triangle_box(corners.map(|index| mesh.positions[index as usize]))
        };
        let count = ids.len() as u32;
        if count == 0 {
            return Self::default();
        }
        let tree = Self::by_ploc(count, box_of, effort).filter(|tree| tree.depth <= depth);
        tree.unwrap_or_else(|| Self::in_halves(count, box_of))
    }

    /// Builds it by PLOC; `None` where that has nothing to compare, or chains its triangles.
    pub(super) fn by_ploc(
        count: u32,
        box_of: impl Fn(u32) -> Aabb,
        effort: Effort,
    ) -> Option<Self> {
        let is_measurable = measurable(count, &box_of);
        let tree = is_measurable
            .then(|| ploc(count, box_of, effort))
            .flatten()?;
        let bvh = Self::of(tree);
        (bvh.depth <= MAX_DEPTH).then_some(bvh)
    }

    /// The same tree in nodes as shaders read them.
    pub(super) fn of(tree: Bvh2) -> Self {
        let nodes = tree.nodes.iter().map(|node| BvhNode {
            min: node.aabb.min.into(),
            first: node.first_index,
            max: node.aabb.max.into(),
            count: node.prim_count,
        });
        Self::new(nodes.collect(), tree.primitive_indices)
    }

    /// The tree of last resort, whose depth is the logarithm of the number of triangles. Meshes
    /// need it that span the range of f32, or whose best tree is a chain: triangles that grow
    /// geometrically, or that share a corner.
    fn in_halves(count: u32, box_of: impl Fn(u32) -> Aabb) -> Self {
        let (nodes, primitives) = in_halves(count, box_of, MAX_LEAF);
        Self::new(nodes, primitives)
    }

    /// Returns the tree reduced to at most `most` nodes (0 counts as 1). Subtrees with the fewest
    /// triangles become leaves, which may be larger than the leaves that [`build`](Self::build)
    /// makes. A tree that is small enough already is returned unchanged.
    pub fn merged(self, most: usize) -> Self {
        if self.nodes.len() <= most.max(1) {
            return self;
        }
        let order = self.order();
        let counts = self.counts(&order);
        let largest = largest_leaf(&self.nodes, &counts, most.max(1));
        let mut nodes = vec![self.nodes[0]];
        let mut primitives = Vec::with_capacity(self.primitives.len());
        // Old nodes, and where they stand now; the second child waits until the first is done.
        let mut open = vec![(0u32, 0usize)];
        while let Some((old, new)) = open.pop() {
            let node = self.nodes[old as usize];
            if node.count == 0 && counts[old as usize] > largest {
                let first = nodes.len();
                nodes[new].first = first as u32;
                for child in [node.first, node.first + 1] {
                    nodes.push(self.nodes[child as usize]);
                }
                open.extend([(node.first + 1, first + 1), (node.first, first)]);
                continue;
            }
            nodes[new].first = primitives.len() as u32;
            nodes[new].count = counts[old as usize];
            self.collect(old, &mut primitives);
        }
        Self::new(nodes, primitives)
    }

    /// Returns the indices of all nodes, each before its children.
    pub fn order(&self) -> Vec<u32> {
        let mut order = Vec::with_capacity(self.nodes.len());
        order.extend((!self.nodes.is_empty()).then_some(0));
        let mut next = 0;
        while let Some(&index) = order.get(next) {
            let node = self.nodes[index as usize];
            if node.count == 0 {
                order.extend([node.first, node.first + 1]);
            }
            next += 1;
        }
        order
    }

    /// Triangles below each node.
    fn counts(&self, order: &[u32]) -> Vec<u32> {
        let mut counts = vec![0; self.nodes.len()];
        for &index in order.iter().rev() {
            let node = self.nodes[index as usize];
            let first = node.first as usize;
            counts[index as usize] = match node.count {
                0 => counts[first] + counts[first + 1],
                count => count,
            };
        }
        counts
    }

    /// Adds all triangles below a node.
    fn collect(&self, root: u32, primitives: &mut Vec<u32>) {
        let mut open = vec![root];
        while let Some(index) = open.pop() {
            let node = self.nodes[index as usize];
            let first = node.first as usize;
            match node.count {
                0 => open.extend([node.first + 1, node.first]),
                count => primitives.extend(&self.primitives[first..first + count as usize]),
            }
        }
    }

    /// Updates the boxes of all nodes for a deformed mesh: the triangles that the tree was built
    /// from, with their corners at other positions.
    ///
    /// # Panics
    /// If the mesh has fewer triangles than the tree was built from.
    pub fn refit(&mut self, mesh: &Mesh) {
        if self.nodes.is_empty() {
            return;
        }
        for index in self.order().into_iter().rev() {
            let node = self.nodes[index as usize];
            let (min, max) = fitted_box(&node, &self.nodes, &self.primitives, mesh);
            let node = &mut self.nodes[index as usize];
            (node.min, node.max) = (min.into(), max.into());
        }
    }

    /// Returns the expected cost of a ray that enters the root's box, in units of one triangle
    /// test; a box test counts as 1.5. It is the surface area heuristic (MacDonald and Booth 1990),
    /// and 0 for an empty tree.
    pub fn cost(&self) -> f64 {
        let Some(root) = self.nodes.first() else {
            return 0.0;
        };
        let cost = self.nodes.iter().map(cost_of).sum::<f64>();
        cost / area(root).max(f64::MIN_POSITIVE)
    }
}

/// The least number of triangles of which subtrees become leaves, so that `most` nodes are left at
/// most.
fn largest_leaf(nodes: &[BvhNode], counts: &[u32], most: usize) -> u32 {
    let inner = nodes.iter().zip(counts).filter(|(node, _)| node.count == 0);
    let mut inner: Vec<u32> = inner.map(|(_, &count)| count).collect();
    inner.sort_unstable_by(|a, b| b.cmp(a));
    // The root, and two nodes for each inner one that stays: those of more triangles.
    let staying = (most - 1) / 2;
    inner.get(staying).copied().unwrap_or(0)
}

/// The box of a triangle by its corners.
pub(super) fn triangle_box(corners: [Vec3; 3]) -> Aabb {
    let [a, b, c] = corners.map(Vec3A::from);
    Aabb::new(a.min(b).min(c), a.max(b).max(c))
}

/// The part of a tree's cost that a node is, in its area.
pub(super) fn cost_of(node: &BvhNode) -> f64 {
    match node.count {
        0 => BOX * area(node),
        count => f64::from(count) * area(node),
    }
}

/// Returns the box of a node: of its triangles, or around its children's boxes.
pub(super) fn fitted_box(
    node: &BvhNode,
    nodes: &[BvhNode],
    primitives: &[u32],
    mesh: &Mesh,
) -> (Vec3, Vec3) {
    let (first, count) = (node.first as usize, node.count as usize);
    if count == 0 {
        let [a, b] = [nodes[first], nodes[first + 1]];
        let low = Vec3::from(a.min).min(b.min.into());
        return (low, Vec3::from(a.max).max(b.max.into()));
    }
    let primitives = primitives[first..first + count].iter();
    let corners = primitives.flat_map(|&id| mesh.triangles[id as usize]);
    bounds(corners.map(|corner| mesh.positions[corner as usize])).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn some_meshes_do_need_the_tree_of_last_resort() {
        // Each triangle 1.5 times as large as the one before, from one corner: PLOC joins the two
        // smallest, then the next …
        let box_of = |place: u32| {
            let size = 1.5f32.powi(place as i32 - 120);
            let corners = [Vec3::new(size, size, 0.0), Vec3::new(0.0, size, size)];
            triangle_box([Vec3::ZERO, corners[0], corners[1]])
        };
        assert!(Bvh::by_ploc(200, box_of, Effort::Thorough).is_none());
        assert!(Bvh::in_halves(200, box_of).depth < 8);
    }
}
