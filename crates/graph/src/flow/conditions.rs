//! Which passes run or are skipped together, and what a skipped pass leaves behind.

use super::view::GraphView;
use crate::{
    diagnostics::reports::Reports,
    errors::flow::OrderError,
    instantiate::flat::Run,
    link::pass::{Access, LinkedPass, PassId},
    resource::{Origin, ResourceId},
};
use petgraph::unionfind::UnionFind;
use std::collections::{BTreeMap, BTreeSet};

/// When a pass runs in this plan.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum When {
    /// In every frame.
    Always,
    /// In no frame: its condition is false.
    Never,
    /// In the first frame.
    Once,
    /// When something that it reads has changed.
    OnChange,
    /// When its group does: a capture between two writes.
    Follows,
}

/// Run conditions of a schedule, worked out. They are flat because every frame reads them.
#[derive(Clone, Debug, Default)]
pub struct Conditions {
    /// For every position in the schedule, the first position of its group. A group runs or is
    /// skipped as a whole.
    pub group: Vec<usize>,
    /// For every position in the schedule.
    pub when: Vec<When>,
    /// Every position in the schedule with every resource that is written there.
    pub written: Vec<(usize, ResourceId)>,
    /// For every resource, by id, the group of the passes that write it; of one with `keep`, which
    /// may have several, that of the first.
    pub writers: Vec<Option<usize>>,
    /// The resources that must outlive the frame: those with `keep`, and those that a pass writes
    /// which may be skipped.
    pub kept: BTreeSet<ResourceId>,
}

impl Conditions {
    /// True if a pass of a group writes a resource.
    pub fn is_written_by(&self, group: usize, id: ResourceId) -> bool {
        let mut written = self.written.iter();
        written.any(|(at, of)| *of == id && self.group[*at] == group)
    }

    /// True if a pass of the groups that run writes a resource before the pass at `at` reads it.
    pub fn is_written_before(
        &self,
        (id, keep): (ResourceId, bool),
        at: usize,
        runs: &[bool],
    ) -> bool {
        if !keep {
            return self.writers[id.index()].is_some_and(|group| runs[group]);
        }
        let mut above = self.written.iter().take_while(|(by, _)| *by < at);
        above.any(|(by, of)| *of == id && runs[self.group[*by]])
    }
}

/// Joins all writers of one resource, and with them each pass that reads a version that is
/// overwritten later in the frame: were the writers skipped, only the last version would be there.
/// A group of several conditions is reported. A resource with `keep` joins only writers of one
/// condition: a pass that runs finds what was left by those that ran before it.
pub(crate) fn conditions(
    view: GraphView<'_>,
    schedule: &[PassId],
    reports: &mut Reports,
) -> Conditions {
    let mut uses: BTreeMap<ResourceId, Vec<(usize, &Access)>> = BTreeMap::new();
    for (at, &pass) in schedule.iter().enumerate() {
        for access in &view.pass(pass).accesses {
            uses.entry(access.resource).or_default().push((at, access));
        }
    }
    let mut joint = UnionFind::new(schedule.len());
    for (id, uses) in &uses {
        if matches!(view.resource(*id).origin, Origin::Previous(_)) {
            continue;
        }
        let writers: Vec<_> = uses.iter().filter(|(_, access)| access.writes).collect();
        if view.resource(*id).keep {
            join_by_condition(&mut joint, &writers, |at| &view.pass(schedule[at]).run);
            continue;
        }
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
                [first, other].map(|at| view.pass(schedule[*at])),
                &view.resource(*id).name,
                reports,
            );
            joint.union(*first, *other);
        }
    }
    // The first pass of a group is its number.
    let joint = joint.into_labeling();
    let first = |of: &usize| joint.iter().position(|other| other == of);
    let group: Vec<usize> = joint.iter().filter_map(first).collect();
    let mut writers = vec![None; view.resources.len()];
    for (id, uses) in &uses {
        let writer = uses.iter().find(|(_, access)| access.writes);
        writers[id.index()] = writer.map(|(at, _)| group[*at]);
    }
    let mut leads = vec![false; schedule.len()];
    for (&group, &pass) in group.iter().zip(schedule) {
        leads[group] |= !view.pass(pass).is_capture();
    }
    let when = |(&group, &pass): (&usize, &PassId)| match &view.pass(pass).run {
        _ if view.pass(pass).is_capture() && leads[group] => When::Follows,
        Run::Always => When::Always,
        Run::When(_) if view.pass(pass).enabled => When::Always,
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
        kept: outliving(view, schedule, &uses),
    }
}

/// The resources that must outlive the frame.
fn outliving(
    view: GraphView<'_>,
    schedule: &[PassId],
    uses: &BTreeMap<ResourceId, Vec<(usize, &Access)>>,
) -> BTreeSet<ResourceId> {
    let may_be_skipped = |(at, access): &(usize, &Access)| {
        access.writes && view.pass(schedule[*at]).run != Run::Always
    };
    let outlives = |id: ResourceId, uses: &[(usize, &Access)]| {
        view.resource(id).keep || uses.iter().any(may_be_skipped)
    };
    let outliving = uses.iter().filter(|(id, uses)| outlives(**id, uses));
    outliving.map(|(id, _)| *id).collect()
}

/// Joins the positions of writers that have one run condition.
fn join_by_condition<'r>(
    joint: &mut UnionFind<usize>,
    writers: &[&(usize, &Access)],
    run: impl Fn(usize) -> &'r Run,
) {
    for (at, _) in writers {
        let first = writers.iter().find(|(first, _)| run(*first) == run(*at));
        joint.union(first.map_or(*at, |(first, _)| *first), *at);
    }
}

fn check([a, b]: [&LinkedPass; 2], name: &str, reports: &mut Reports) {
    // A capture between two writes runs when these do.
    if a.run == b.run || [a, b].iter().any(|pass| pass.is_capture()) {
        return;
    }
    reports.report(OrderError::RunConditions {
        name: name.to_owned(),
        passes: [a, b].map(|pass| pass.name.clone()),
        runs: [a, b].map(|pass| pass.run.to_string()),
    });
}
