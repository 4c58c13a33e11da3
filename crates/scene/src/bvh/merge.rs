//! A hierarchy made smaller: subtrees of few triangles become leaves.

use super::tree::{Bvh, BvhNode};

impl Bvh {
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
