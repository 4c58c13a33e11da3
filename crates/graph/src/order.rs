//! Phase 5: the file reads as a sequential program. Every access gets the version it means, and with it the edges.

use crate::{
    diagnostics::{Code, Diagnostic},
    link::{Access, LinkedPass},
    plan::CAPTURE,
    resolve::{Origin, Part, Resource, ResourceId, ResourceKind, Resources, Target},
};
use petgraph::{
    graph::{DiGraph, NodeIndex},
    visit::EdgeFiltered,
};
use std::collections::{BTreeMap, BTreeSet};

/// Why one pass comes before another.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Hazard {
    /// The later one reads what the earlier one wrote.
    ReadAfterWrite,
    /// The later one overwrites what the earlier one reads.
    WriteAfterRead,
    /// The later one overwrites what the earlier one wrote.
    WriteAfterWrite,
}

/// One mip of one layer of a texture, or a buffer: what has versions.
type Cell = (ResourceId, u32, u32);

/// Earlier pass, later pass and why, with the resources that it comes through.
pub(crate) type Dependences = BTreeMap<(usize, usize, Hazard), BTreeSet<ResourceId>>;

/// The dependency graph: node i is pass i of the file, an edge runs from the earlier to the later pass.
#[derive(Debug)]
pub(crate) struct Order {
    pub edges: DiGraph<(), Hazard>,
    /// The same edges, with the resources behind them; drawings show both.
    pub dependences: Dependences,
    /// The pass that writes each cell last.
    last: BTreeMap<Cell, usize>,
}

impl Order {
    /// The passes whose versions of a part of a resource are final.
    pub fn final_writers(&self, target: &Target) -> BTreeSet<usize> {
        cells(target.id, &target.part)
            .filter_map(|cell| self.last.get(&cell).copied())
            .collect()
    }
}

#[derive(Default)]
struct State {
    writer: Option<usize>,
    readers: BTreeSet<usize>,
}

fn cells(resource: ResourceId, part: &Part) -> impl Iterator<Item = Cell> + use<> {
    let layers = part.layers.clone();
    part.mips
        .clone()
        .flat_map(move |mip| layers.clone().map(move |layer| (resource, mip, layer)))
}

/// The order of all passes, from which follows which of them are live. Reads of what nobody wrote are reported for the first
/// `judged` passes: below them a pass is missing that might have written it.
pub(crate) fn order(
    passes: &[LinkedPass],
    judged: usize,
    resources: &Resources<'_>,
    diagnostics: &mut Vec<Diagnostic>,
) -> Order {
    let (order, early) = walk(passes, &resources.list, |_| true);
    for (index, access) in early.into_iter().filter(|(index, _)| *index < judged) {
        diagnostics.push(explain(index, access, passes, resources, &order));
    }
    order
}

/// The order among the live passes alone. A chain of overwrites that led through a culled pass is closed here: first, culled,
/// last would else leave nothing that keeps the first before the last.
pub(crate) fn order_of_live(
    passes: &[LinkedPass],
    resources: &Resources<'_>,
    live: &[bool],
) -> Order {
    walk(passes, &resources.list, |pass| live[pass]).0
}

/// What the passes that run depend on, and through which resources.
pub(crate) fn dependences(
    passes: &[LinkedPass],
    resources: &[Resource],
    runs: impl Fn(usize) -> bool,
) -> Dependences {
    walk(passes, resources, runs).0.dependences
}

/// Runs through the file as a sequential program and notes what depends on what, and the reads of what nobody wrote.
fn walk<'p>(
    passes: &'p [LinkedPass],
    resources: &[Resource],
    runs: impl Fn(usize) -> bool,
) -> (Order, Vec<(usize, &'p Access)>) {
    let mut dependences = Dependences::new();
    let mut states: BTreeMap<Cell, State> = BTreeMap::new();
    let mut early: Vec<(usize, &Access)> = Vec::new();
    for (index, pass) in passes.iter().enumerate().filter(|(index, _)| runs(*index)) {
        for access in &pass.accesses {
            let resource = &resources[access.resource.0];
            let has_content =
                resource.origin != Origin::Own || matches!(resource.kind, ResourceKind::Sampler(_));
            for cell in cells(access.resource, &access.part) {
                let state = states.entry(cell).or_default();
                let mut edge = |from: usize, hazard| {
                    if from != index {
                        dependences
                            .entry((from, index, hazard))
                            .or_default()
                            .insert(access.resource);
                    }
                };
                match state.writer {
                    Some(writer) if access.reads => edge(writer, Hazard::ReadAfterWrite),
                    // A write that does not cover keeps some of the old version, so it reads it.
                    Some(writer) if access.writes && !access.covers => {
                        edge(writer, Hazard::ReadAfterWrite)
                    }
                    None if access.reads
                        && !has_content
                        && !early.iter().any(|(pass, other)| {
                            *pass == index && other.resource == access.resource
                        }) =>
                    {
                        early.push((index, access));
                    }
                    _ => {}
                }
                if access.writes {
                    if let Some(writer) = state.writer {
                        edge(writer, Hazard::WriteAfterWrite);
                    }
                    for &reader in &state.readers {
                        edge(reader, Hazard::WriteAfterRead);
                    }
                    state.readers.clear();
                    state.writer = Some(index);
                }
                if access.reads {
                    state.readers.insert(index);
                }
            }
        }
    }
    let mut graph = DiGraph::with_capacity(passes.len(), dependences.len());
    let nodes: Vec<NodeIndex> = passes.iter().map(|_| graph.add_node(())).collect();
    for &(from, to, hazard) in dependences.keys() {
        graph.add_edge(nodes[from], nodes[to], hazard);
    }
    let last = states
        .into_iter()
        .filter_map(|(cell, state)| Some((cell, state.writer?)))
        .collect();
    let order = Order {
        edges: graph,
        dependences,
        last,
    };
    (order, early)
}

/// A read with nothing written above it: written never, written below, or written below by a pass that needs the reader.
fn explain(
    reader: usize,
    access: &Access,
    passes: &[LinkedPass],
    resources: &Resources<'_>,
    order: &Order,
) -> Diagnostic {
    let name = &resources.get(access.resource).name;
    let pass = &passes[reader];
    // A pass that changes what it reads depends on no pass below, whoever else changes it there: it lacks a beginning.
    let itself = access.writes
        || pass
            .accesses
            .iter()
            .any(|other| other.writes && other.resource == access.resource);
    let below = (reader + 1..passes.len()).find(|&index| {
        passes[index].accesses.iter().any(|other| {
            other.writes && other.resource == access.resource && other.part.overlaps(&access.part)
        })
    });
    if pass.kind == CAPTURE {
        let first = below.map(|writer| passes[writer].name.as_str());
        return Diagnostic::error(
            Code::Output,
            format!(
                "`{}` cannot be read back: nothing has written it yet",
                *pass.name
            ),
        )
        .help(first.map_or("no pass writes it".to_owned(), |first| {
            format!("it is first written by `{first}`")
        }));
    }
    let Some(writer) = below.filter(|_| !itself) else {
        let help = if itself {
            format!(
                "put `Clear(name: \"clear_{name}\", target: \"{name}\")` above it: it starts from what was there before"
            )
        } else {
            "let a pass above write it, or name another material".to_owned()
        };
        let verb = if itself { "reads and changes" } else { "reads" };
        let part = passes[..reader].iter().any(|earlier| {
            earlier.accesses.iter().any(|other| {
                other.writes
                    && other.resource == access.resource
                    && other.part.overlaps(&access.part)
            })
        });
        let what = if part { "a part of " } else { "" };
        return Diagnostic::error(
            Code::ReadBeforeWrite,
            format!(
                "pass `{}` {verb} {what}`{name}` that no pass has written",
                *pass.name
            ),
        )
        .at(access.span.clone(), "read here")
        .at(pass.name.span.clone(), "by this pass")
        .help(help);
    };
    // Only what a pass needs makes it depend on another; an overwrite could be moved.
    let needs = EdgeFiltered::from_fn(&order.edges, |edge| {
        *edge.weight() == Hazard::ReadAfterWrite
    });
    let path = petgraph::algo::astar(
        &needs,
        NodeIndex::new(reader),
        |node| node.index() == writer,
        |_| 1u64,
        |_| 0,
    );
    let writer_name = &passes[writer].name;
    match path {
        Some((_, path)) => {
            let mut names: Vec<&str> = path
                .iter()
                .map(|node| passes[node.index()].name.as_str())
                .collect();
            names.push(&pass.name.value);
            Diagnostic::error(
                Code::Cycle,
                format!("passes need each other's results: {}", names.join(" → ")),
            )
            .at(pass.name.span.clone(), format!("reads `{name}`"))
            .at(
                writer_name.span.clone(),
                format!("writes `{name}`, and needs what `{}` made", *pass.name),
            )
            .help("break the cycle: write a second material, or move the read into a pass below")
        }
        None => Diagnostic::error(
            Code::ReadBeforeWrite,
            format!("pass `{}` reads `{name}` before it is written", *pass.name),
        )
        .at(access.span.clone(), "read here")
        .at(pass.name.span.clone(), "by this pass")
        .at(writer_name.span.clone(), "written only here, below")
        .help(format!(
            "move `{}` above `{}`: the file reads as a sequential program",
            writer_name.value, *pass.name
        )),
    }
}
