//! What was made for a graph, how, and in what time.

use std::time::Duration;

/// One resource as it was made last.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Built {
    /// Its name.
    pub name: &'static str,
    /// What was done.
    pub how: How,
    /// What that took on the CPU, uploads included.
    pub time: Duration,
    /// How often it was made, this time included.
    pub times: u32,
}

/// What was done for a resource.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum How {
    /// Made of what is set.
    Made,
    /// A hierarchy whose boxes were fitted to a deformed mesh; its tree is as it was.
    Refitted,
}
