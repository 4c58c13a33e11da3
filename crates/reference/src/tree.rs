//! Traversal of the scene's hierarchy by f64 rays.

use crate::{
    Error,
    ray::{Corners, Ray},
};
use glam::DVec3;
use skiagraph_scene::{Bvh, Mesh};
use std::{borrow::Cow, ops::ControlFlow};

/// A hierarchy with its triangles' corners in leaf order.
pub(crate) struct Tree<'a> {
    bvh: Cow<'a, Bvh>,
    corners: Vec<Corners>,
    bounds: Option<(DVec3, DVec3)>,
}

impl<'a> Tree<'a> {
    /// Checks that `bvh` was built over `mesh` as far as traversal depends on it.
    pub(crate) fn new(mesh: &Mesh, bvh: Cow<'a, Bvh>) -> Result<Self, Error> {
        if bvh.primitives.len() != mesh.triangles.len() {
            return Err(Error::Hierarchy("it has another number of triangles"));
        }
        if bvh
            .primitives
            .iter()
            .any(|&primitive| primitive as usize >= mesh.triangles.len())
        {
            return Err(Error::Hierarchy(
                "a leaf names a triangle that the mesh does not have",
            ));
        }
        let mut reached = vec![false; bvh.nodes.len()];
        let mut open: Vec<usize> = if bvh.nodes.is_empty() {
            Vec::new()
        } else {
            vec![0]
        };
        while let Some(index) = open.pop() {
            // A node reached twice would count its triangles twice, or never let a traversal end.
            if index >= bvh.nodes.len() || std::mem::replace(&mut reached[index], true) {
                return Err(Error::Hierarchy(
                    "a node's child lies outside it or belongs to another node too",
                ));
            }
            let node = &bvh.nodes[index];
            let first = node.first as usize;
            if node.count == 0 {
                open.extend([first, first + 1]);
            } else if first + node.count as usize > bvh.primitives.len() {
                return Err(Error::Hierarchy("a leaf reaches beyond its triangles"));
            }
        }
        let corners = bvh
            .primitives
            .iter()
            .map(|&primitive| {
                mesh.triangles[primitive as usize]
                    .map(|index| mesh.positions[index as usize].to_array())
            })
            .collect();
        let bounds = mesh
            .bounds()
            .map(|(min, max)| (min.as_dvec3(), max.as_dvec3()));
        Ok(Self {
            bvh,
            corners,
            bounds,
        })
    }

    /// Distance from `origin` beyond which there is no corner.
    pub(crate) fn reach(&self, origin: DVec3) -> f64 {
        self.bounds.map_or(0.0, |(min, max)| {
            (origin - min).abs().max((origin - max).abs()).length()
        })
    }

    /// Calls `visit` with primitive id, corners and the current end of the ray for every triangle whose box the ray enters,
    /// nearer boxes first. `visit` may shorten the ray, or end the walk by `Break`. `stack` is scratch memory.
    pub(crate) fn walk(
        &self,
        ray: &Ray,
        stack: &mut Vec<u32>,
        mut visit: impl FnMut(u32, &Corners, &mut f64) -> ControlFlow<()>,
    ) {
        let nodes = &self.bvh.nodes;
        let mut t_max = f64::INFINITY;
        stack.clear();
        if nodes
            .first()
            .is_some_and(|root| ray.enters(root, t_max).is_some())
        {
            stack.push(0);
        }
        while let Some(index) = stack.pop() {
            let node = &nodes[index as usize];
            let first = node.first as usize;
            if node.count > 0 {
                for slot in first..first + node.count as usize {
                    if visit(self.bvh.primitives[slot], &self.corners[slot], &mut t_max).is_break()
                    {
                        return;
                    }
                }
                continue;
            }
            match (
                ray.enters(&nodes[first], t_max),
                ray.enters(&nodes[first + 1], t_max),
            ) {
                (Some(left), Some(right)) if left <= right => {
                    stack.extend([node.first + 1, node.first])
                }
                (Some(_), Some(_)) => stack.extend([node.first, node.first + 1]),
                (Some(_), None) => stack.push(node.first),
                (None, Some(_)) => stack.push(node.first + 1),
                (None, None) => {}
            }
        }
    }
}
