//! Phase 6: a pass that no output needs does not run.

use crate::order::{Hazard, Order};
use petgraph::{Direction, graph::NodeIndex, visit::EdgeRef};

/// Whether each pass is live: it makes one of the `roots`, or something that a live pass reads in this frame or, by `keeps`,
/// in the next one.
pub(crate) fn live<K: IntoIterator<Item = usize>>(
    order: &Order,
    roots: impl IntoIterator<Item = usize>,
    keeps: impl Fn(usize) -> K,
) -> Vec<bool> {
    let mut live = vec![false; order.edges.node_count()];
    let mut open: Vec<usize> = roots.into_iter().collect();
    while let Some(pass) = open.pop() {
        if std::mem::replace(&mut live[pass], true) {
            continue;
        }
        let needed = order
            .edges
            .edges_directed(NodeIndex::new(pass), Direction::Incoming);
        open.extend(
            needed
                .filter(|edge| *edge.weight() == Hazard::ReadAfterWrite)
                .map(|edge| edge.source().index()),
        );
        open.extend(keeps(pass));
    }
    live
}
