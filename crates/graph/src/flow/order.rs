//! Dependences between passes. The passes as they are [arranged](super::arrange) are a sequential
//! program: each access uses the content that the passes before it left, which gives the edges of
//! the dependency graph.

use super::arrange::writers;
use super::view::{GraphView, Subresources};
use crate::diagnostics::Reports;
use crate::errors::flow::OrderError;
use crate::kinds::Step;
use crate::link::{Access, LinkedPass, PassId};
use crate::resource::{ResourceId, ResourceKind, Target, name_within};
use crate::source::Located;
use petgraph::graph::DiGraph;
use std::collections::{BTreeMap, BTreeSet};

/// Reason for which one pass of a plan must run before another one that uses the same part of a
/// texture or buffer.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Hazard {
    /// The later pass reads content that the earlier pass wrote.
    ReadAfterWrite,
    /// The later pass writes where the earlier pass still reads former content.
    WriteAfterRead,
    /// The later pass writes where the earlier pass wrote, so its content must come last.
    WriteAfterWrite,
}

/// Dependences between passes of a plan. A key is the id of the earlier pass, the id of the later
/// pass, and the reason for which the earlier one must run first. Its value is the set of resources
/// that cause the dependence, never empty.
pub type Dependences = BTreeMap<(PassId, PassId, Hazard), BTreeSet<ResourceId>>;

/// Dependency graph of passes: node i is pass i, and an edge runs from the earlier to the later
/// pass.
#[derive(Debug)]
pub(crate) struct Order {
    /// The edges between passes, each with its reason. The index of a node is that of the pass.
    pub edges: DiGraph<(), Hazard>,
    /// The edges together with the resources that cause them, for drawings.
    pub dependences: Dependences,
    /// The pass that writes each subresource last.
    last: BTreeMap<(ResourceId, [u32; 3]), PassId>,
    subresources: Subresources,
}

impl Order {
    /// Returns the passes that write a part of a resource last: of each mip, layer or range of
    /// items in the part, the last pass that writes it.
    pub fn final_writers(&self, target: &Target) -> BTreeSet<PassId> {
        let parts = self.subresources.within(target.id, &target.part);
        let writers = parts.filter_map(|part| self.last.get(&(target.id, part)));
        writers.copied().collect()
    }
}

#[derive(Default)]
struct State {
    writer: Option<PassId>,
    readers: BTreeSet<PassId>,
}

/// Finds the dependences of all passes, which decide later which passes are live, and reports reads
/// before any write. Of a document with mistakes only the first `first_invalid` passes are read so,
/// and only as far as no pass with a mistake can have written the content.
pub(crate) fn order(view: GraphView<'_>, first_invalid: usize, reports: &mut Reports) -> Order {
    let (order, uninitialized) = walk(view, |_| true);
    if uninitialized.is_empty() {
        return order;
    }
    let (_, in_file_order) = writers(view, &order.subresources);
    let is_complete = first_invalid == view.passes.len();
    for (reader, access) in uninitialized {
        let error = explain(reader, access, view, &in_file_order, is_complete);
        if let Some(error) = error.filter(|_| reader.0 < first_invalid) {
            reports.report(error);
        }
    }
    order
}

/// Finds the dependences between the passes for which `runs` is true, as if no others existed.
pub(crate) fn dependences(view: GraphView<'_>, runs: impl Fn(PassId) -> bool) -> Dependences {
    walk(view, runs).0.dependences
}

/// Reads the passes for which `runs` is true as a sequential program. Returns their dependences,
/// and the reads that come before any write.
pub(super) fn walk<'p>(
    view: GraphView<'p>,
    runs: impl Fn(PassId) -> bool,
) -> (Order, Vec<(PassId, &'p Access)>) {
    let subresources = Subresources::new(view);
    let mut dependences = Dependences::new();
    let mut states: BTreeMap<(ResourceId, [u32; 3]), State> = BTreeMap::new();
    let mut uninitialized: Vec<(PassId, &Access)> = Vec::new();
    for (index, pass) in view.ids().filter(|(index, _)| runs(*index)) {
        for access in &pass.accesses {
            let has_content = view.resource(access.resource).has_content();
            for part in subresources.within(access.resource, &access.part) {
                let state = states.entry((access.resource, part)).or_default();
                let mut edge = |from: PassId, hazard| {
                    if from != index {
                        let between = dependences.entry((from, index, hazard)).or_default();
                        between.insert(access.resource);
                    }
                };
                match state.writer {
                    Some(writer) if access.reads => edge(writer, Hazard::ReadAfterWrite),
                    // A write that does not cover keeps some of the old version, so it reads it.
                    Some(writer) if access.writes && !access.fully_overwrites => {
                        edge(writer, Hazard::ReadAfterWrite)
                    }
                    None if access.reads
                        && !has_content
                        && !uninitialized.iter().any(|(pass, other)| {
                            *pass == index && other.resource == access.resource
                        }) =>
                    {
                        uninitialized.push((index, access));
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
    let edges = view.graph(dependences.keys().copied());
    let states = states.into_iter();
    let last = states.filter_map(|(part, state)| Some((part, state.writer?)));
    let order = Order {
        edges,
        dependences,
        last: last.collect(),
        subresources,
    };
    (order, uninitialized)
}

/// Returns the error for a read with no write before it: the resource is written never, or only
/// behind the reader. `None` for a reader in a cycle, which is reported, and where a pass with a
/// mistake may be the writer.
fn explain(
    reader: PassId,
    access: &Access,
    view: GraphView<'_>,
    in_file_order: &BTreeSet<ResourceId>,
    is_complete: bool,
) -> Option<OrderError> {
    let name = view.resource(access.resource).name.clone();
    let pass = view.pass(reader);
    let writes = |pass: &LinkedPass| pass.writes_to(access.resource, &access.part);
    // A pass that changes its own input depends on no pass below, even if one changes it there: it
    // lacks a beginning.
    let mut accesses = pass.accesses.iter();
    let itself =
        access.writes || accesses.any(|other| other.writes && other.resource == access.resource);
    let below = view.passes[reader.0 + 1..].iter();
    let below = below.filter(|pass| writes(pass)).map(|pass| &pass.name);
    let below: Vec<&Located<String>> = below.collect();
    let partly = view.passes[..reader.0].iter().any(writes);
    if pass.is_capture() {
        return is_complete.then(|| OrderError::Capture {
            name: pass.name.value.clone(),
            first: below.first().map(|writer| writer.value.clone()),
            partly,
        });
    }
    let (read, pass_name) = (access.span.clone(), pass.name.clone());
    if !itself && !below.is_empty() && in_file_order.contains(&access.resource) {
        return Some(OrderError::WrittenBelow {
            name,
            pass: pass_name,
            read,
            writers: below.into_iter().cloned().collect(),
        });
    }
    let is_sure = itself || is_complete && below.is_empty();
    is_sure.then(|| OrderError::Unwritten {
        name,
        clear: itself.then(|| clear_above(pass, access, view)),
        pass: pass_name,
        read,
        partly,
    })
}

/// Returns the `Clear` that a document can put above a pass, for what an access of the pass
/// changes: the reference to it, and the whole entry.
fn clear_above(pass: &LinkedPass, access: &Access, view: GraphView<'_>) -> [String; 2] {
    let resource = view.resource(access.resource);
    let name = name_within(&pass.name, &resource.name);
    let (target, value) = match &resource.kind {
        ResourceKind::Texture(texture) => {
            let part = access.part.reference(name, texture);
            (part, cleared_depth(pass, access, texture.format))
        }
        _ => (name.to_owned(), ""),
    };
    let is_letter = |sign: &char| sign.is_alphanumeric() || *sign == '_';
    let word: String = name.chars().filter(is_letter).collect();
    let word = ["clear", "reset", "begin"].map(|verb| format!("{verb}_{word}"));
    let is_free = |word: &&String| !view.passes.iter().any(|pass| pass.name.ends_with(*word));
    let word = word.iter().find(is_free).unwrap_or(&word[0]);
    let clear = format!("Clear(name: \"{word}\", target: \"{target}\"{value})");
    [target, clear]
}

/// Returns the field `value` of a `Clear` after which every depth passes the test of a pass once;
/// empty for a format without depth.
fn cleared_depth(pass: &LinkedPass, access: &Access, format: wgt::TextureFormat) -> &'static str {
    let depth = match pass.steps.get(access.step) {
        Some(Step::Draw(draw)) => draw.depth.as_ref(),
        _ => None,
    };
    use wgt::CompareFunction::{Greater, GreaterEqual};
    let is_reversed = depth.is_some_and(|depth| matches!(depth.compare, Greater | GreaterEqual));
    match (format.has_depth_aspect(), format.has_stencil_aspect()) {
        (false, _) => "",
        (true, _) if is_reversed => ", value: 0",
        (true, false) => ", value: 1",
        (true, true) => ", value: (1, 0)",
    }
}
