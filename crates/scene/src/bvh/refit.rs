//! The boxes of a tree after its mesh was deformed.

use super::tree::{Bvh, BvhNode};
use crate::mesh::Mesh;
use glam::Vec3;

/// Cost of a box beside a triangle: as where the tree is built.
const BOX: f64 = 1.5;

impl Bvh {
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

fn area(node: &BvhNode) -> f64 {
    let size = Vec3::from(node.max).as_dvec3() - Vec3::from(node.min).as_dvec3();
    size.x * size.y + size.y * size.z + size.z * size.x
}
