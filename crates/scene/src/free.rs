//! Lists with gaps that are filled again.

use std::ops::Range;

/// Ranges of a list that nothing uses, in ascending order.
#[derive(Clone, Debug, Default)]
pub struct Free(Vec<Range<usize>>);

impl Free {
    /// Takes a range and returns its start; `None` if no free one has so many items.
    pub fn take(&mut self, count: usize) -> Option<usize> {
        if count == 0 {
            return Some(0);
        }
        let free = self.0.iter_mut().find(|free| free.len() >= count)?;
        let first = free.start;
        free.start += count;
        Some(first)
    }

    /// Adds a range, joined to those that it touches.
    pub fn give_back(&mut self, range: Range<usize>) {
        self.0.push(range);
        self.0.retain(|free| !free.is_empty());
        self.0.sort_unstable_by_key(|free| free.start);
        self.0.dedup_by(|next, free| {
            let are_one = free.end == next.start;
            if are_one {
                free.end = next.end;
            }
            are_one
        });
    }

    /// Returns the most items that one range has.
    pub fn longest(&self) -> usize {
        self.0.iter().map(Range::len).max().unwrap_or_default()
    }
}
