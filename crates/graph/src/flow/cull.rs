//! Culling: finds the passes that an output needs. All others do not run.

use super::order::{Hazard, Order};
use crate::link::PassId;
use petgraph::{Direction, graph::NodeIndex, visit::EdgeRef};

/// Finds the live passes; the result has an entry for each pass. A pass is live if it is in
/// `roots`, if a live pass reads content that it wrote in this frame, or if `keeps` returns it for
/// a live pass: a pass whose content is needed in the next frame.
pub(crate) fn live<K: IntoIterator<Item = PassId>>(
    order: &Order,
    roots: impl IntoIterator<Item = PassId>,
    keeps: impl Fn(PassId) -> K,
) -> Vec<bool> {
    let mut live = vec![false; order.edges.node_count()];
    let mut open: Vec<PassId> = roots.into_iter().collect();
    while let Some(pass) = open.pop() {
        if std::mem::replace(&mut live[pass.0], true) {
            continue;
        }
        let (edges, node) = (&order.edges, NodeIndex::new(pass.0));
        let needed = edges.edges_directed(node, Direction::Incoming);
        let needed = needed.filter(|edge| *edge.weight() == Hazard::ReadAfterWrite);
        open.extend(needed.map(|edge| PassId(edge.source().index())));
        open.extend(keeps(pass));
    }
    live
}
