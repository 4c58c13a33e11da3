//! The hierarchy as shaders and tracers walk it.

use crate::mesh::Mesh;
use glam::Vec3;

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

/// Cost of a box beside a triangle: as where the tree is built.
const BOX: f64 = 1.5;

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

    /// The same boxes, as many of them as `most` allows (1 at least): each subtree of so few
    /// triangles becomes one leaf, be it larger than a leaf that [`build`](Self::build) makes. The
    /// tree stays as it is where it is small enough.
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

    /// All nodes, each before its children.
    pub(super) fn order(&self) -> Vec<u32> {
        let mut order = vec![0];
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

    /// Fits all boxes to the mesh, which has the triangles that the tree was built of, at other
    /// places.
    ///
    /// # Panics
    /// If the mesh has fewer triangles.
    pub fn refit(&mut self, mesh: &Mesh) {
        if self.nodes.is_empty() {
            return;
        }
        for index in self.order().into_iter().rev() {
            let node = self.nodes[index as usize];
            let (first, count) = (node.first as usize, node.count as usize);
            let (min, max) = if count == 0 {
                let [a, b] = [self.nodes[first], self.nodes[first + 1]];
                let low = Vec3::from(a.min).min(b.min.into());
                (low, Vec3::from(a.max).max(b.max.into()))
            } else {
                let primitives = self.primitives[first..first + count].iter();
                let corners = primitives.flat_map(|&id| mesh.triangles[id as usize]);
                corners
                    .map(|corner| mesh.positions[corner as usize])
                    .fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(min, max), p| {
                        (min.min(p), max.max(p))
                    })
            };
            let node = &mut self.nodes[index as usize];
            (node.min, node.max) = (min.into(), max.into());
        }
    }

    /// Returns the cost of a ray through the root's box, in triangle tests: the surface area
    /// heuristic (MacDonald and Booth 1990).
    pub fn cost(&self) -> f64 {
        let Some(root) = self.nodes.first() else {
            return 0.0;
        };
        let cost = |node: &BvhNode| match node.count {
            0 => BOX * area(node),
            count => f64::from(count) * area(node),
        };
        self.nodes.iter().map(cost).sum::<f64>() / area(root).max(f64::MIN_POSITIVE)
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

fn area(node: &BvhNode) -> f64 {
    let size = Vec3::from(node.max).as_dvec3() - Vec3::from(node.min).as_dvec3();
    size.x * size.y + size.y * size.z + size.z * size.x
}
