//! Resources made for a graph, how, and in what time.

use crate::lights;
use crate::names::{BVH_NODES, BVH_PRIMITIVES, LIGHT_SPACE_NODES, LIGHT_SPACE_PRIMITIVES};
use std::time::Duration;

/// Record of how a [`SceneProvider`](crate::SceneProvider) has built one resource: the kind and
/// time of the last build, and the number of all builds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct Built {
    /// Name of the resource, such as `scene.bvh_nodes`. A single light `lights[2]` is recorded as
    /// `lights`.
    pub name: &'static str,
    /// Kind of work that the last build was.
    pub how: How,
    /// Wall time on the CPU that the last build took, with its upload to the GPU; for a camera or a
    /// single light without it, which is the executors'.
    pub time: Duration,
    /// Number of bytes that the CPU uploaded to the GPU in the last build, or told executors.
    pub uploaded: u64,
    /// Number of times that the provider has built or refitted the resource so far.
    pub times: u32,
}

/// The two buffers of a hierarchy, which one build makes.
const TOGETHER: [[&str; 2]; 2] = [
    [BVH_NODES, BVH_PRIMITIVES],
    [LIGHT_SPACE_NODES, LIGHT_SPACE_PRIMITIVES],
];

impl Built {
    /// True if the build has also made the resource that plans call `name`
    /// ([`Plan::provided`](skiagraph_graph::Plan::provided)): a single light is made with its list,
    /// and the two buffers of a hierarchy together.
    pub fn makes(&self, name: &str) -> bool {
        let name = lights::list_of(name).unwrap_or(name);
        let is_one_of = |pair: &[&str; 2]| pair.contains(&name) && pair.contains(&self.name);
        name == self.name || TOGETHER.iter().any(is_one_of)
    }
}

/// Kind of work that builds a resource of a [`SceneProvider`](crate::SceneProvider).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum How {
    /// The resource, or those of its items that have changed, was built and uploaded.
    Made,
    /// A bounding-volume hierarchy was kept, and its boxes were fitted to a mesh that was deformed
    /// or whose parts have moved, come or gone.
    Refitted,
}

/// Work that a [`SceneProvider`](crate::SceneProvider) has done since it was created, by counters
/// that only grow. The work of one frame is the difference of two values ([`since`](Self::since));
/// it is 0 for a frame in which nothing moves.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct Work {
    /// Number of bytes that the CPU has written to buffers of the GPU, and those of cameras and
    /// single lights, which executors bring there.
    pub uploaded: u64,
    /// Number of bytes that the GPU has copied from a buffer into the new one that replaces it,
    /// when only some of its items have changed.
    pub copied: u64,
    /// Number of positions in the parts of the mesh (or in the whole mesh, if it has no parts) that
    /// were moved, deformed, rewritten or added.
    pub moved: u64,
    /// Number of nodes of bounding-volume hierarchies whose boxes were fitted or built.
    pub nodes: u64,
    /// Number of positions that were visited to fit the light space of a light (the space of its
    /// shadow map) around the mesh.
    pub laid: u64,
    /// Number of triangles over which acceleration structures of the device were built; a
    /// top level over them is made anew with them, and is not counted.
    pub triangles: u64,
}

impl Work {
    /// Returns the work that was done since `before`, which is an earlier value of the same
    /// provider's [`work`](crate::SceneProvider::work).
    pub fn since(self, before: Self) -> Self {
        Self {
            uploaded: self.uploaded - before.uploaded,
            copied: self.copied - before.copied,
            moved: self.moved - before.moved,
            nodes: self.nodes - before.nodes,
            laid: self.laid - before.laid,
            triangles: self.triangles - before.triangles,
        }
    }
}
