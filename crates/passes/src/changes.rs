//! How a mesh has changed.

use crate::names::next_version;
use std::ops::Range;

/// Number of ranges of cleared triangles that are kept apart.
const CLEARED: usize = 256;

/// How the places of parts, or parts, have changed a mesh.
#[derive(Clone, Copy, Default)]
pub(crate) struct Change {
    /// Corners have moved.
    pub is_elsewhere: bool,
    /// Triangles have other corners.
    pub is_turned: bool,
    /// Triangles have other materials.
    pub is_painted: bool,
    /// The mesh has more items.
    pub is_grown: bool,
}

impl Change {
    /// Corners have moved, and nothing else.
    pub const MOVED: Self = Self {
        is_elsewhere: true,
        is_turned: false,
        is_painted: false,
        is_grown: false,
    };
}

/// Triangles of parts that were removed, each with the number of that change.
#[derive(Clone, Default)]
pub(crate) struct Cleared(Vec<(Range<usize>, u64)>);

impl Cleared {
    /// Notes that triangles were cleared.
    pub fn clear(&mut self, triangles: Range<usize>) {
        if self.0.len() == CLEARED {
            // Rather one long range than ever more.
            let ranges = self.0.drain(..).map(|(range, _)| range);
            let whole = ranges.reduce(|a, b| a.start.min(b.start)..a.end.max(b.end));
            self.0.extend(whole.map(|range| (range, next_version())));
        }
        self.0.push((triangles, next_version()));
    }

    /// The ranges that were cleared after a version of the winding.
    pub fn since(&self, version: u64) -> impl Iterator<Item = Range<usize>> {
        let cleared = self.0.iter();
        let cleared = cleared.filter(move |(_, number)| *number > version);
        cleared.map(|(range, _)| range.clone())
    }
}
