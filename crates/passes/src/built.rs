//! Resources made for a graph, how, and in what time.

use std::time::Duration;

/// One resource as it was made last.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Built {
    /// Its name.
    pub name: &'static str,
    /// Kind of work.
    pub how: How,
    /// Time that it took on the CPU, uploads included.
    pub time: Duration,
    /// How often it was made, this time included.
    pub times: u32,
}

/// Kinds of work for a resource.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum How {
    /// Made of what is set.
    Made,
    /// A hierarchy whose boxes were fitted to a deformed mesh; its tree is as it was.
    Refitted,
}
