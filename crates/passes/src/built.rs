//! Resources made for a graph, how, and in what time.

use std::time::Duration;

/// Record of the builds of one resource by a [`SceneProvider`](crate::SceneProvider). It describes
/// the last of them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct Built {
    /// Name of the resource, such as `scene.bvh_nodes`. A single light `lights[2]` is recorded as
    /// `lights`.
    pub name: &'static str,
    /// Kind of work that the last build was.
    pub how: How,
    /// Wall time on the CPU that the last build took, with its upload to the GPU.
    pub time: Duration,
    /// Number of times that the provider has built or refitted the resource so far.
    pub times: u32,
}

/// Kind of work that builds a resource of a [`SceneProvider`](crate::SceneProvider).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum How {
    /// The resource was built from scratch and uploaded.
    Made,
    /// The boxes of a bounding-volume hierarchy were fitted to a deformed mesh and uploaded; its
    /// tree stayed as it was.
    Refitted,
}
