//! Resources made for a graph, how, and in what time.

use std::time::Duration;

/// Record of the last time that a [`SceneProvider`](crate::SceneProvider) built a resource.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Built {
    /// Name of the resource, such as `scene.bvh_nodes`; `lights` also for a single light
    /// `lights[2]`.
    pub name: &'static str,
    /// Kind of work that built the resource.
    pub how: How,
    /// CPU time that the last build took, with its upload.
    pub time: Duration,
    /// Number of times that the provider has built the resource so far.
    pub times: u32,
}

/// Kind of work that builds a resource.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum How {
    /// The resource was built from scratch.
    Made,
    /// The boxes of a bounding-volume hierarchy were fitted to a deformed mesh; its tree stayed as
    /// it was.
    Refitted,
}
