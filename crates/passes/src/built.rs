//! Resources made for a graph, how, and in what time.

use std::time::Duration;

/// Record of the last time that a resource was made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Built {
    /// Name of the resource.
    pub name: &'static str,
    /// Kind of work that made the resource.
    pub how: How,
    /// CPU time that the work took, uploads included.
    pub time: Duration,
    /// Number of times that the resource was made, this time included.
    pub times: u32,
}

/// Kind of work that makes a resource.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum How {
    /// The resource was made from the scene as it is set.
    Made,
    /// The boxes of a hierarchy were fitted to a deformed mesh; its tree stayed as it was.
    Refitted,
}
