//! Linking of all passes, one after the other.

use super::{capture, pass::LinkedPass, rounds, scope::PassScope, steps};
use crate::{
    diagnostics::{Reported, Reports},
    errors::{instantiate::InterfaceError, layout::LayoutError, link::LinkError},
    instantiate::{Flat, InstanceId, LoweredPass},
    language::Reference,
    request::Capture,
    resource::{Origin, Resource, ResourceKind},
};
use std::collections::BTreeSet;

/// All passes of a graph after linking, with its resources.
pub(crate) struct Linked<'a> {
    /// Resources of the graph, with their sizes, the meanings of names, and what else flattening
    /// found. `first_invalid` is the number of passes above the first mistake. After a mistake all
    /// passes are in the order of the documents, and writes of those below it are not known.
    pub flat: Flat<'a>,
    /// The linked passes and captures, in the order in which they run.
    pub passes: Vec<LinkedPass>,
    /// Use of a document (the loaded one or an include) that each pass belongs to, parallel to
    /// `passes`; `None` for a capture.
    pub instances: Vec<Option<InstanceId>>,
    /// Index in `passes` of each pass of the documents, by its index before captures were added.
    pub numbers: Vec<usize>,
}

/// Links all passes, brings them into the order that `arrange` returns, and adds the passes of the
/// request's captures. `arrange` is given the passes, the resources, and the number of passes above
/// the first mistake.
pub(crate) fn link<'a>(
    mut flat: Flat<'a>,
    lowered: Vec<LoweredPass<'a>>,
    arrange: impl FnOnce(&[LinkedPass], &[Resource], usize, &mut Reports) -> Vec<usize>,
) -> Linked<'a> {
    let mut scope = PassScope::new(flat.symbols);
    let (mut in_file, mut instances_in_file) = (Vec::new(), Vec::new());
    // The writes of a pass with a mistake are not known.
    let mut first_invalid: Option<usize> = None;
    let mut numbers = Vec::new();
    for (index, pass) in lowered.into_iter().enumerate() {
        numbers.push(in_file.len());
        // For each mistake all names are searched for what was meant.
        if scope.symbols.reports.has_enough() {
            first_invalid.get_or_insert(in_file.len());
            break;
        }
        if flat.first_invalid == Some(index) {
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
    if flat.first_invalid.is_some() {
        first_invalid.get_or_insert(in_file.len());
    }
    let above = first_invalid.unwrap_or(in_file.len());
    let mut reports = std::mem::take(&mut scope.symbols.reports);
    let mut sequence = arrange(&in_file, &scope.symbols.resources, above, &mut reports);
    scope.symbols.reports = reports;
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
    flat.first_invalid = first_invalid.map(place);
    let layouts = std::mem::take(&mut scope.layouts);
    let mut symbols = scope.symbols;
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
    flat.symbols = symbols;
    Linked {
        flat,
        passes,
        instances,
        numbers,
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
        let is_given = scope.get(access.resource).kind.is_given();
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
        self.flat.merged.iter().find_map(|merge| {
            // After a mistake the last passes are not there.
            let between = self.numbers.get(merge.between.clone())?.iter();
            between.copied().find_map(|number| {
                let pass = self.passes.get(number)?;
                let written = pass.accesses.iter().find(|access| {
                    let id = access.resource;
                    let is_own = merge.owned.contains(&id.index())
                        && self.flat.symbols.get(id).origin == Origin::Own;
                    access.writes && (is_own || merge.inputs.contains(&id))
                })?;
                Some(InterfaceError::TwoCopies {
                    graph: merge.graph.clone(),
                    pass: pass.name.value.clone(),
                    material: self.flat.symbols.get(written.resource).name.clone(),
                    span: merge.span.clone(),
                    by: pass.name.span.clone(),
                })
            })
        })
    }
}
