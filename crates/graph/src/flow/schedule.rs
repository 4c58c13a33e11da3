//! Order of the live passes that respects every dependence. Dependences run from a pass to one
//! below it, so this is the order of the document.

use super::{aliases::Aliases, conditions::Conditions, lifetimes::Lifetimes, order::Order};
use crate::{link::pass::PassId, resource::ResourceId};
use petgraph::{Direction, graph::NodeIndex};
use std::{
    cmp::Reverse,
    collections::{BTreeSet, BinaryHeap},
};

/// The [live](crate#terms) passes of a plan in the order in which they run, with the lifetimes, run
/// conditions and allocations that follow from this order.
#[derive(Clone, Debug, Default)]
#[non_exhaustive]
pub struct Schedule {
    /// Ids of the [live](crate::Plan::live) passes in the order in which they run in a frame. A
    /// *position* is an index into this list.
    pub passes: Vec<PassId>,
    /// First use, last use and usages of each resource that a scheduled pass uses.
    pub lifetimes: Lifetimes,
    /// Frames in which each pass runs, and the groups of passes that run or are skipped together.
    pub conditions: Conditions,
    /// Allocations of textures and buffers on the device, and the resources that share each of
    /// them.
    pub aliases: Aliases,
    /// Textures and buffers of the graph that a [live](crate#terms) pass also reads as they were in
    /// the frame before (`.previous`). The device holds two of each, for which
    /// [`aliases`](Self::aliases) has one allocation that no other resource shares. A frame that
    /// runs a writer of the resource writes one and reads the other as `.previous`, and then they
    /// change places. In a frame without its writers both names are the one that was written last.
    pub ping_pong: BTreeSet<ResourceId>,
}

/// Orders the live passes by Kahn's algorithm; of the passes that could come next, the first in the
/// document is taken. (petgraph's own topological sort does not keep this order.)
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
