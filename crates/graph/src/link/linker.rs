//! Linking of all passes, one after the other.

use super::{
    capture,
    pass::{Access, LinkedPass},
    rounds,
    scope::PassScope,
    steps,
};
use crate::{
    diagnostics::reports::{Reported, Reports},
    errors::{instantiate::InterfaceError, layout::LayoutError, link::LinkError},
    instantiate::{
        flat::{Interface, Merge, PlanInputs},
        lower::{Lowered, LoweredPass},
        scopes::InstanceId,
        symbols::SymbolTable,
    },
    language::syntax::Reference,
    request::Capture,
    resource::{Origin, Resource, ResourceId, ResourceKind, SubresourceRange},
};
use std::collections::BTreeSet;

/// All passes of a graph after linking, with its resources.
pub(crate) struct Linked<'a> {
    /// Resources of the graph, with their sizes, and the meanings of names.
    pub symbols: SymbolTable<'a>,
    /// The linked passes and captures, in the order in which they run.
    pub passes: Vec<LinkedPass>,
    /// Use of a document (the loaded one or an include) that each pass belongs to, parallel to
    /// `passes`; `None` for a capture.
    pub instances: Vec<Option<InstanceId>>,
    /// Index in `passes` of each pass of the documents, by its index before captures were added.
    pub numbers: Vec<usize>,
    /// Includes that are replaced by an earlier include of the same content.
    pub merged: Vec<Merge>,
    /// Number of passes above the first mistake; `None` without a mistake. After a mistake all
    /// passes are in the order of the documents, and writes of those below it are not known.
    pub first_invalid: Option<usize>,
    /// Inputs and outputs of each use of a document: of the loaded document and of every include.
    pub interfaces: Vec<Interface>,
    /// Params and features that decide which entries of the documents exist.
    pub plan_inputs: PlanInputs,
}

/// Links all passes, brings them into the order that `arrange` returns, and adds the passes of the
/// request's captures. `arrange` is given the passes, the resources, and the number of passes above
/// the first mistake.
pub(crate) fn link<'a>(
    lowered: Lowered<'a>,
    arrange: impl FnOnce(&[LinkedPass], &[Resource], usize, &mut Reports) -> Vec<usize>,
) -> Linked<'a> {
    let mut scope = PassScope::new(lowered.symbols);
    let (mut in_file, mut instances_in_file) = (Vec::new(), Vec::new());
    // The writes of a pass with a mistake are not known.
    let mut first_invalid: Option<usize> = None;
    let mut numbers = Vec::new();
    for (index, pass) in lowered.passes.into_iter().enumerate() {
        numbers.push(in_file.len());
        // For each mistake all names are searched for what was meant.
        if scope.reports().has_enough() {
            first_invalid.get_or_insert(in_file.len());
            break;
        }
        if lowered.first_invalid == Some(index) {
            first_invalid.get_or_insert(in_file.len());
        }
        let (instance, is_broken) = (pass.instance, pass.is_broken);
        match link_pass(pass, &mut scope) {
            Ok(linked) if !is_broken => {
                in_file.push(linked);
                instances_in_file.push(instance);
            }
            _ => drop(first_invalid.get_or_insert(in_file.len())),
        }
    }
    if lowered.first_invalid.is_some() {
        first_invalid.get_or_insert(in_file.len());
    }
    let above = first_invalid.unwrap_or(in_file.len());
    let mut reports = std::mem::take(scope.reports());
    let mut sequence = arrange(&in_file, &scope.symbols().resources, above, &mut reports);
    *scope.reports() = reports;
    if first_invalid.is_some() {
        sequence.sort_unstable();
    }
    let (passes, places) = with_captures(in_file, &sequence, &mut scope);
    let mut instances = vec![None; passes.len()];
    for (place, instance) in places.iter().zip(instances_in_file) {
        instances[*place] = Some(instance);
    }
    let place = |index: usize| places.get(index).copied().unwrap_or(passes.len());
    let numbers = numbers.into_iter().map(place).collect();
    let first_invalid = first_invalid.map(place);
    let layouts = std::mem::take(&mut scope.layouts);
    let mut symbols = scope.into_symbols();
    let (buffers, errors) = layouts.sized(&symbols);
    for error in errors {
        match error {
            LayoutError::TooLarge { .. } | LayoutError::Alignment { .. } => {
                // The report suffices: nothing here depends on the result.
                let _ = symbols.reports.unsupported(error);
            }
            error @ LayoutError::Swapped { .. } => symbols.reports.warn(error),
            error => drop(symbols.reports.report(error)),
        }
    }
    for (id, buffer) in buffers {
        symbols.resources[id.index()].kind = ResourceKind::Buffer(buffer);
    }
    symbols.size_previous();
    Linked {
        symbols,
        passes,
        instances,
        numbers,
        merged: lowered.merged,
        first_invalid,
        interfaces: lowered.interfaces,
        plan_inputs: lowered.plan_inputs,
    }
}

/// Brings passes into the order of `sequence`, each with the captures after it. Returns the place
/// of each pass, too.
fn with_captures(
    in_file: Vec<LinkedPass>,
    sequence: &[usize],
    scope: &mut PassScope<'_>,
) -> (Vec<LinkedPass>, Vec<usize>) {
    let (mut passes, mut places) = (Vec::new(), vec![0; in_file.len()]);
    let mut in_file: Vec<Option<LinkedPass>> = in_file.into_iter().map(Some).collect();
    for &index in sequence {
        let Some(pass) = in_file[index].take() else {
            continue;
        };
        let after = |capture: &&Capture| capture.after.as_ref() == Some(&pass.name.value);
        let captures: BTreeSet<&Capture> = scope.request().captures.iter().filter(after).collect();
        places[index] = passes.len();
        passes.push(pass);
        for capture in captures {
            // A capture that cannot be was reported, and nothing needs it.
            if let Ok(captured) = capture::link(capture, &passes, scope) {
                passes.push(captured);
            }
        }
    }
    (passes, places)
}

fn link_pass<'a>(mut pass: LoweredPass<'a>, scope: &mut PassScope<'a>) -> Reported<LinkedPass> {
    scope.enter(&mut pass);
    let flat = pass.flat;
    let mut linked = steps::link(flat.name, flat.pass.kind, &pass.steps, scope)?;
    linked.run = flat.run;
    linked.turns = flat.turns;
    scope.unasked()?;
    if let (Some(round), Some(_)) = (flat.round, flat.pass.overwrites.first()) {
        return Err(rounds::refused("`overwrites`", &round, scope));
    }
    overwrites(&mut linked, &flat.pass.overwrites, scope)?;
    if let Some(reads) = &flat.pass.reads {
        self::reads(&linked, reads, scope)?;
    }
    Ok(linked)
}

/// Checks the `reads` of a document's entry against the resources that the pass reads.
fn reads(pass: &LinkedPass, references: &[Reference], scope: &mut PassScope<'_>) -> Reported<()> {
    let mut stated = BTreeSet::new();
    for reference in references {
        let id = scope.resolve(reference)?.id;
        stated.insert(id);
        let mut read = pass.accesses.iter().filter(|access| access.reads);
        if !read.any(|access| access.resource == id) {
            let pass = pass.name.value.clone();
            return Err(scope.report(LinkError::ReadsNot(pass, reference.located())));
        }
    }
    let unstated = pass.accesses.iter().find(|access| {
        let kind = &scope.get(access.resource).kind;
        let is_given = matches!(kind, ResourceKind::Provided(_) | ResourceKind::Frame)
            || matches!(
                kind,
                ResourceKind::AccelerationStructure | ResourceKind::CpuWork
            );
        access.reads && !is_given && !stated.contains(&access.resource)
    });
    match unstated {
        None => Ok(()),
        Some(access) => {
            let name = scope.get(access.resource).name.clone();
            let (reader, read) = (pass.name.clone(), access.span.clone());
            Err(scope.report(LinkError::ReadsMore(reader, name, read)))
        }
    }
}

/// Marks the writes that a document's entry lists in `overwrites` as complete: the pass overwrites
/// everything in these parts.
fn overwrites(
    pass: &mut LinkedPass,
    references: &[Reference],
    scope: &mut PassScope<'_>,
) -> Reported<()> {
    for reference in references {
        let target = scope.resolve(reference)?;
        let mut is_written = false;
        for access in &mut pass.accesses {
            // Depth and stencil of one texture are attached apart.
            let part = access.part.of_aspect(target.part.aspect);
            if access.writes && access.resource == target.id && part == target.part {
                is_written = true;
                access.fully_overwrites = true;
                // The pass reads only what it has written itself.
                access.reads = false;
            }
        }
        if !is_written {
            let pass = pass.name.value.clone();
            return Err(scope.report(LinkError::Overwrites(pass, reference.located())));
        }
    }
    Ok(())
}

impl Linked<'_> {
    /// Returns the error for the first include that cannot be merged with the earlier one, because
    /// a pass between them writes a resource that it reads or writes; `None` if all can.
    pub fn two_copies(&self) -> Option<InterfaceError> {
        self.merged.iter().find_map(|merge| {
            // After a mistake the last passes are not there.
            let between = self.numbers.get(merge.between.clone())?.iter();
            between.copied().find_map(|number| {
                let pass = self.passes.get(number)?;
                let written = pass.accesses.iter().find(|access| {
                    let id = access.resource;
                    let is_own = merge.owned.contains(&id.index())
                        && self.symbols.get(id).origin == Origin::Own;
                    access.writes && (is_own || merge.inputs.contains(&id))
                })?;
                Some(InterfaceError::TwoCopies {
                    graph: merge.graph.clone(),
                    pass: pass.name.value.clone(),
                    material: self.symbols.get(written.resource).name.clone(),
                    span: merge.span.clone(),
                    by: pass.name.span.clone(),
                })
            })
        })
    }

    /// True if the pass at the index `pass` in `passes` writes to a part of the resource `id` that
    /// overlaps `part`.
    pub fn writes(&self, pass: usize, id: ResourceId, part: &SubresourceRange) -> bool {
        let writes =
            |access: &Access| access.writes && access.resource == id && access.part.overlaps(part);
        self.passes[pass].accesses.iter().any(writes)
    }
}
