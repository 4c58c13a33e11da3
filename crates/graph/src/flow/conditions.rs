//! Groups of passes that run or are skipped together in a frame, by their run conditions.

use super::view::GraphView;
use crate::diagnostics::Reports;
use crate::errors::flow::OrderError;
use crate::instantiate::Run;
use crate::link::{Access, LinkedPass, PassId};
use crate::resource::{Origin, ResourceId};
use petgraph::unionfind::UnionFind;
use std::collections::{BTreeMap, BTreeSet};

/// Frames in which a pass of a [`Schedule`](crate::Schedule) runs: the [`Run`] of its document,
/// with the condition of [`Run::When`] evaluated. An executor leaves out all passes of a frame that
/// would compute the same as one before; such frames are not meant by *every frame* below.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum When {
    /// In every frame: the pass has [`Run::Always`], or the condition of its [`Run::When`] is true
    /// in every frame of this plan.
    Always,
    /// In no frame: the condition of its [`Run::When`] is false in every frame of this plan.
    Never,
    /// In the frames whose numbers [`LinkedPass::turns`] names.
    InTurn,
    /// In the frames of [`Run::Once`].
    Once,
    /// In the frames of [`Run::OnChange`].
    OnChange,
    /// In frames where another pass of its group (see [`Conditions`]) runs: the pass copies a
    /// material for a [capture](crate#terms) between two passes that write the material.
    Follows,
}

/// Run conditions of the passes of a schedule. A *position* is an index into
/// [`Schedule::passes`](crate::Schedule::passes). A *group* is a set of passes that run or are
/// skipped together in a frame, because they write the same resource or read content of it that a
/// later pass overwrites (of a resource with `keep`, only its writers with the same [`Run`]); its
/// number is the position of its first pass. All passes of a group have the same [`When`], except
/// copies that captures need, which have [`When::Follows`].
#[derive(Clone, Debug, Default)]
pub struct Conditions {
    /// Number of the group of each pass, by position in
    /// [`Schedule::passes`](crate::Schedule::passes). The number of a group is the position of its
    /// first pass.
    pub group: Vec<usize>,
    /// Frames in which each pass runs, by position in
    /// [`Schedule::passes`](crate::Schedule::passes).
    pub when: Vec<When>,
    /// Pairs of the position of a pass in [`Schedule::passes`](crate::Schedule::passes) and a
    /// resource that the pass writes, sorted by position. A pair occurs once for each write.
    pub written: Vec<(usize, ResourceId)>,
    /// Number of the [group](Self::group) that writes each resource, by [`ResourceId::index`];
    /// `None` if no scheduled pass writes the resource. A resource with `keep` may be written by
    /// several groups; the entry is the number of the first.
    pub writers: Vec<Option<usize>>,
    /// Resources with `keep`, and those written by a pass that may be skipped, whose [`Run`] is not
    /// `Always`: their content must outlive the frame.
    pub kept: BTreeSet<ResourceId>,
}

impl Conditions {
    /// Returns true if a pass of the [group](Self::group) with the number `group` writes the
    /// resource `id`.
    pub fn is_written_by(&self, group: usize, id: ResourceId) -> bool {
        let mut written = self.written.iter();
        written.any(|(at, resource)| *resource == id && self.group[*at] == group)
    }

    /// Returns true if a pass that runs in this frame writes the resource `id` before the pass at
    /// position `at` in [`Schedule::passes`](crate::Schedule::passes) reads it. `keep` is
    /// [`Resource::keep`](crate::Resource::keep) of the resource. `runs` has an entry for each
    /// position; at the number of a [group](Self::group) it is true if the group runs in this
    /// frame.
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
        above.any(|(by, resource)| *resource == id && runs[self.group[*by]])
    }
}

/// Finds the groups of a schedule. All writers of a resource are one group, and with them every
/// pass that reads content that a later pass overwrites: if the writers were skipped, only the last
/// content would be left. A group whose passes have several run conditions is reported. For a
/// resource with `keep`, only writers with the same condition are joined: a pass that runs finds
/// the content that the passes before it left.
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
            let mut later = writers.iter().filter(|(later, _)| later > at);
            access.writes || later.any(|(_, other)| other.part.overlaps(&access.part))
        };
        let mut joined = uses.iter().filter(is_overwritten);
        let Some((first, _)) = joined.next() else {
            continue;
        };
        for (other, _) in joined {
            let passes = [first, other].map(|at| view.pass(schedule[*at]));
            check(passes, &view.resource(*id).name, reports);
            joint.union(*first, *other);
        }
    }
    // The first pass of a group is its number.
    let mut first = vec![None; schedule.len()];
    let labels = joint.into_labeling().into_iter().enumerate();
    let group: Vec<usize> = labels
        .map(|(at, label)| *first[label].get_or_insert(at))
        .collect();
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
        Run::When(_) => match view.pass(pass).turns.as_slice() {
            turns if !turns.contains(&true) => When::Never,
            turns if !turns.contains(&false) => When::Always,
            _ => When::InTurn,
        },
        Run::Once => When::Once,
        Run::OnChange => When::OnChange,
    };
    let writes = uses.iter().flat_map(|(id, uses)| {
        let writes = uses.iter().filter(|(_, access)| access.writes);
        writes.map(|(at, _)| (*at, *id))
    });
    let mut written: Vec<(usize, ResourceId)> = writes.collect();
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

/// Returns the resources whose content must outlive the frame.
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

/// Joins the writers that have the same run condition into one group each.
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
