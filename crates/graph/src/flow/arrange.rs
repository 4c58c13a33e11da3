//! Order of the passes, derived from what they read and write.

use super::view::{GraphView, Subresources};
use crate::diagnostics::Reports;
use crate::errors::flow::OrderError;
use crate::link::PassId;
use crate::resource::{ResourceId, name_within};
use petgraph::algo::{astar, kosaraju_scc};
use petgraph::graph::{DiGraph, Edge, NodeIndex};
use std::cmp::Reverse;
use std::collections::{BTreeMap, BTreeSet, BinaryHeap};

/// Reason for which a pass comes before another one.
#[derive(Clone, Copy)]
enum Reason {
    /// The later pass reads content of the resource that only the earlier one writes.
    Reads(ResourceId),
    /// Both use the resource, whose passes keep the order of the file.
    FileOrder(ResourceId),
}

type Needs = DiGraph<(), Reason>;

/// Writer of each part of a resource; of several the last in the file.
type Writers = BTreeMap<(ResourceId, [u32; 3]), PassId>;

/// Finds the writers of all parts, and the resources whose passes keep the order of the file: those
/// that have content before the first pass, and those with a part that several passes write.
pub(super) fn writers(
    view: GraphView<'_>,
    subresources: &Subresources,
) -> (Writers, BTreeSet<ResourceId>) {
    let (mut writers, mut in_file_order) = (Writers::new(), BTreeSet::new());
    for (pass, linked) in view.ids() {
        for access in linked.accesses.iter().filter(|access| access.writes) {
            let id = access.resource;
            if view.resource(id).has_content() {
                in_file_order.insert(id);
            }
            for part in subresources.within(id, &access.part) {
                let before = writers.insert((id, part), pass);
                if before.is_some_and(|before| before != pass) {
                    in_file_order.insert(id);
                }
            }
        }
    }
    (writers, in_file_order)
}

/// Returns the order of the passes: their indices in the file. A pass comes behind the writer of
/// all that it reads; passes that use a resource with several writers, or with content before the
/// first pass, keep the order of the file; so do all passes that nothing orders. A cycle among the
/// first `first_invalid` passes is reported, and its passes keep the order of the file.
pub(crate) fn arrange(
    view: GraphView<'_>,
    first_invalid: usize,
    reports: &mut Reports,
) -> Vec<usize> {
    let needs = needs(view);
    let is_backward = |edge: &Edge<Reason>| edge.source() > edge.target();
    if !needs.raw_edges().iter().any(is_backward) {
        return (0..view.passes.len()).collect();
    }
    let mut component = vec![0; view.passes.len()];
    let components = kosaraju_scc(&needs);
    for (number, nodes) in components.iter().enumerate() {
        nodes
            .iter()
            .for_each(|node| component[node.index()] = number);
    }
    let mut reported = BTreeSet::new();
    let mut sorted = needs.clone();
    sorted.retain_edges(|_, index| {
        let edge = &needs.raw_edges()[index.index()];
        let [from, to] = [edge.source(), edge.target()].map(|node| component[node.index()]);
        let closes = is_backward(edge) && from == to;
        let mut nodes = components[to].iter();
        if closes && nodes.all(|node| node.index() < first_invalid) && reported.insert(to) {
            reports.report(cycle(view, &needs, edge));
        }
        !closes
    });
    topological(&sorted)
}

/// Finds the reasons for which passes come before others.
fn needs(view: GraphView<'_>) -> Needs {
    let subresources = Subresources::new(view);
    let (writers, in_file_order) = writers(view, &subresources);
    let mut reasons: BTreeMap<(PassId, PassId), Reason> = BTreeMap::new();
    let mut last: BTreeMap<ResourceId, PassId> = BTreeMap::new();
    for (pass, linked) in view.ids() {
        for access in &linked.accesses {
            let id = access.resource;
            if in_file_order.contains(&id) {
                let before = (access.reads || access.writes).then(|| last.insert(id, pass));
                if let Some(before) = before.flatten() {
                    let reason = reasons.entry((before, pass));
                    reason.or_insert(Reason::FileOrder(id));
                }
            } else if access.reads {
                for part in subresources.within(id, &access.part) {
                    if let Some(writer) = writers.get(&(id, part)) {
                        reasons.insert((*writer, pass), Reason::Reads(id));
                    }
                }
            }
        }
    }
    let between = reasons.into_iter().filter(|((from, to), _)| from != to);
    view.graph(between.map(|((from, to), reason)| (from, to, reason)))
}

/// Sorts nodes so that every edge runs forward: of those that may come next, the first in the file.
fn topological(needs: &Needs) -> Vec<usize> {
    let mut missing = vec![0; needs.node_count()];
    for edge in needs.raw_edges() {
        missing[edge.target().index()] += 1;
    }
    let ready = (0..missing.len()).filter(|node| missing[*node] == 0);
    let mut ready: BinaryHeap<Reverse<usize>> = ready.map(Reverse).collect();
    let mut sequence = Vec::with_capacity(missing.len());
    while let Some(Reverse(node)) = ready.pop() {
        sequence.push(node);
        for next in needs.neighbors(NodeIndex::new(node)) {
            missing[next.index()] -= 1;
            if missing[next.index()] == 0 {
                ready.push(Reverse(next.index()));
            }
        }
    }
    sequence
}

/// Returns the error for the shortest cycle that an edge closes.
fn cycle(view: GraphView<'_>, needs: &Needs, closing: &Edge<Reason>) -> OrderError {
    let (writer, reader) = (closing.source(), closing.target());
    let path = astar(needs, reader, |node| node == writer, |_| 1u64, |_| 0);
    let path = path.map_or_else(Vec::new, |(_, path)| path);
    let pass = |node: NodeIndex| &view.passes[node.index()].name;
    let name = |id: ResourceId| view.resource(id).name.clone();
    let (mut ring, mut moves) = (Vec::new(), None);
    for (from, to) in std::iter::once(&writer).chain(&path).zip(&path) {
        let reason = needs.edges_connecting(*from, *to).next();
        let (from, to) = (&pass(*from).value, pass(*to));
        let label = match reason.map(|edge| edge.weight()) {
            Some(Reason::FileOrder(id)) => {
                moves.get_or_insert_with(|| [to.value.clone(), from.clone(), name(*id)]);
                format!("uses `{}` below `{from}`", name(*id))
            }
            Some(Reason::Reads(id)) => format!("reads `{}` of `{from}`", name(*id)),
            None => continue,
        };
        ring.push((to.clone(), label));
    }
    let (Reason::Reads(read) | Reason::FileOrder(read)) = closing.weight;
    OrderError::Cycle {
        previous: name_within(pass(reader), &name(read)).to_owned(),
        ring,
        moves,
    }
}
