//! Phase 8, first half: which passes run or are skipped together, and what a skipped pass leaves behind.

use crate::{
    diagnostics::{Code, Diagnostic},
    document::Run,
    link::{Access, LinkedPass},
    plan::CAPTURE,
    resolve::{Origin, Resource, ResourceId},
};
use std::collections::{BTreeMap, BTreeSet};

/// When a pass runs in this plan.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum When {
    Always,
    Never,
    Once,
    OnChange,
    /// When its group does: a capture between two writes.
    Follows,
}

/// What the run conditions of a schedule come to. Every frame reads it, hence it is flat.
#[derive(Clone, Debug, Default)]
pub(crate) struct Conditions {
    /// For every position in the schedule, the first position of its group. A group runs or is skipped as a whole.
    pub group: Vec<usize>,
    /// For every position in the schedule.
    pub when: Vec<When>,
    /// Every position in the schedule with every resource that is written there.
    pub written: Vec<(usize, ResourceId)>,
    /// For every resource, by id, the group of the passes that write it.
    pub writers: Vec<Option<usize>>,
    /// The resources that must outlive the frame because a pass that writes them may be skipped.
    pub kept: BTreeSet<ResourceId>,
}

/// Joins all writers of one resource, and with them whoever reads a version that is overwritten later in the frame: were the
/// writers skipped, only the last version would be there. A group of several conditions is reported.
pub(crate) fn conditions(
    passes: &[LinkedPass],
    schedule: &[usize],
    resources: &[Resource],
    diagnostics: &mut Vec<Diagnostic>,
) -> Conditions {
    let mut uses: BTreeMap<ResourceId, Vec<(usize, &Access)>> = BTreeMap::new();
    for (at, &pass) in schedule.iter().enumerate() {
        for access in &passes[pass].accesses {
            uses.entry(access.resource).or_default().push((at, access));
        }
    }
    let mut group: Vec<usize> = (0..schedule.len()).collect();
    for (id, uses) in &uses {
        if matches!(resources[id.0].origin, Origin::Previous(_)) {
            continue;
        }
        let writers: Vec<_> = uses.iter().filter(|(_, access)| access.writes).collect();
        let is_overwritten = |(at, access): &&(usize, &Access)| {
            access.writes
                || writers
                    .iter()
                    .any(|(later, other)| later > at && other.part.overlaps(&access.part))
        };
        let mut joined = uses.iter().filter(is_overwritten);
        let Some((first, _)) = joined.next() else {
            continue;
        };
        for (other, _) in joined {
            check(
                [first, other].map(|at| &passes[schedule[*at]]),
                &resources[id.0].name,
                diagnostics,
            );
            join(&mut group, *first, *other);
        }
    }
    let group: Vec<usize> = (0..group.len()).map(|at| root(&group, at)).collect();
    let mut writers = vec![None; resources.len()];
    for (id, uses) in &uses {
        let writer = uses.iter().find(|(_, access)| access.writes);
        writers[id.0] = writer.map(|(at, _)| group[*at]);
    }
    let kept = uses
        .iter()
        .filter(|(_, uses)| {
            uses.iter()
                .any(|(at, access)| access.writes && passes[schedule[*at]].run != Run::Always)
        })
        .map(|(id, _)| *id)
        .collect();
    let mut leads = vec![false; schedule.len()];
    for (&group, &pass) in group.iter().zip(schedule) {
        leads[group] |= passes[pass].kind != CAPTURE;
    }
    let when = |(&group, &pass): (&usize, &usize)| match &passes[pass].run {
        _ if passes[pass].kind == CAPTURE && leads[group] => When::Follows,
        Run::Always => When::Always,
        Run::When(_) if passes[pass].enabled => When::Always,
        Run::When(_) => When::Never,
        Run::Once => When::Once,
        Run::OnChange => When::OnChange,
    };
    let mut written: Vec<(usize, ResourceId)> = uses
        .iter()
        .flat_map(|(id, uses)| uses.iter().map(|(at, access)| (*at, *id, access.writes)))
        .filter_map(|(at, id, writes)| writes.then_some((at, id)))
        .collect();
    written.sort();
    let when = group.iter().zip(schedule).map(when).collect();
    Conditions {
        group,
        when,
        written,
        writers,
        kept,
    }
}

/// The first position of a group.
fn root(group: &[usize], mut at: usize) -> usize {
    while group[at] != at {
        at = group[at];
    }
    at
}

fn join(group: &mut [usize], a: usize, b: usize) {
    let (a, b) = (root(group, a), root(group, b));
    group[a.max(b)] = a.min(b);
}

fn check([a, b]: [&LinkedPass; 2], name: &str, diagnostics: &mut Vec<Diagnostic>) {
    // What is captured between two writes runs when these do.
    if a.run == b.run || [a, b].iter().any(|pass| pass.kind == CAPTURE) {
        return;
    }
    diagnostics.push(
        Diagnostic::error(
            Code::RunCondition,
            format!(
                "passes `{}` and `{}` must run or be skipped together, for the sake of `{name}`",
                *a.name, *b.name
            ),
        )
        .at(b.name.span.clone(), format!("`run: {}`", b.run))
        .at(a.name.span.clone(), format!("`run: {}`", a.run))
        .help(format!(
            "both write it, or one reads what the other overwrites: give both the same `run`, or one of them another material than `{name}`"
        )),
    );
}
