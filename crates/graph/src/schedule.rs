//! Phase 7: an order of the live passes that every edge agrees with; ties keep the order of the file.

use crate::order::Order;
use petgraph::{Direction, graph::NodeIndex};
use std::{cmp::Reverse, collections::BinaryHeap};

/// Kahn's algorithm on file order (petgraph's own topological sort does not keep it).
pub(crate) fn schedule(order: &Order, live: &[bool]) -> Vec<usize> {
    let live_neighbours = |pass: usize, direction| {
        order
            .edges
            .neighbors_directed(NodeIndex::new(pass), direction)
            .map(NodeIndex::index)
            .filter(|&other| live[other])
    };
    let mut waiting: Vec<usize> = (0..live.len())
        .map(|pass| live_neighbours(pass, Direction::Incoming).count())
        .collect();
    let mut ready: BinaryHeap<Reverse<usize>> = (0..live.len())
        .filter(|&pass| live[pass] && waiting[pass] == 0)
        .map(Reverse)
        .collect();
    let mut schedule = Vec::new();
    while let Some(Reverse(pass)) = ready.pop() {
        schedule.push(pass);
        for next in live_neighbours(pass, Direction::Outgoing) {
            waiting[next] -= 1;
            if waiting[next] == 0 {
                ready.push(Reverse(next));
            }
        }
    }
    schedule
}
