//! An order of the live passes that every edge agrees with; ties keep the order of the file.

use super::{aliases::Aliases, conditions::Conditions, lifetimes::Lifetimes, order::Order};
use crate::{link::pass::PassId, resource::ResourceId};
use petgraph::{Direction, graph::NodeIndex};
use std::{
    cmp::Reverse,
    collections::{BTreeSet, BinaryHeap},
};

/// The live passes in the order in which they run, and what follows from that.
#[derive(Debug, Default)]
pub struct Schedule {
    /// The passes; a *position* is a place in this list.
    pub passes: Vec<PassId>,
    /// Use of each resource: for what, and from which pass to which.
    pub lifetimes: Lifetimes,
    /// Which passes run or are skipped together, and when.
    pub conditions: Conditions,
    /// Which resources take turns in one allocation.
    pub aliases: Aliases,
    /// The resources that are also read as they were in the frame before: two allocations take
    /// turns.
    pub ping_pong: BTreeSet<ResourceId>,
}

/// Kahn's algorithm on file order (petgraph's own topological sort does not keep it).
pub(crate) fn sequence(order: &Order, live: &[bool]) -> Vec<PassId> {
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
        schedule.push(PassId(pass));
        for next in live_neighbours(pass, Direction::Outgoing) {
            waiting[next] -= 1;
            if waiting[next] == 0 {
                ready.push(Reverse(next));
            }
        }
    }
    schedule
}
