//! Which passes run in a frame, by what changed since they ran last.

use super::pass::{MadePass, Seen};
use crate::{
    conditions::When,
    memory::{Histories, Versions},
    plan::Plan,
    resolve::{Origin, ResourceId},
};
use std::collections::BTreeMap;

/// What the resources of a plan hold, as far as it can be told without looking: every change of content is a new number.
#[derive(Clone, Debug, Default)]
pub(super) struct Contents {
    /// Of every resource of the plan, by id.
    versions: Vec<u64>,
    clock: u64,
    /// Which of its two allocations holds a resource with a history.
    latest: BTreeMap<ResourceId, usize>,
}

impl Contents {
    /// Contents of a plan of which nothing is known.
    pub fn of(plan: &Plan, clock: u64) -> Self {
        let mut contents = Self {
            versions: vec![0; plan.resources.len()],
            clock,
            latest: BTreeMap::new(),
        };
        for &id in plan.lifetimes.keys() {
            contents.touch(id);
            if plan.versions(id) > 1 {
                contents.latest.insert(id, 0);
            }
        }
        contents
    }

    /// The number of the last change.
    pub fn clock(&self) -> u64 {
        self.clock
    }

    /// Another content.
    pub fn touch(&mut self, id: ResourceId) {
        self.clock += 1;
        self.versions[id.0] = self.clock;
    }

    /// The content is that which another resource had.
    pub fn take_over(&mut self, id: ResourceId, other: &Self, of: ResourceId) {
        self.versions[id.0] = other.versions[of.0];
        if let Some(latest) = other.latest.get(&of) {
            self.latest.insert(id, *latest);
        }
    }

    /// The version that a pass sees of an input: of what it was in the frame before if it reads that.
    fn seen(&self, plan: &Plan, id: ResourceId) -> u64 {
        match plan.resources[id.0].origin {
            Origin::Previous(base) => self.versions[base.0],
            _ => self.versions[id.0],
        }
    }

    /// Whether each pass of the schedule runs. A group runs if one of its passes has a reason to.
    pub fn running(&self, plan: &Plan, passes: &[MadePass], all: bool) -> Vec<bool> {
        let groups = &plan.conditions.group;
        // All is what could run, not what a param forbids.
        let mut runs = vec![false; passes.len()];
        for (&group, when) in groups.iter().zip(&plan.conditions.when) {
            runs[group] |= all && !matches!(when, When::Never | When::Follows);
        }
        // A pass that runs can be the reason for one before it in its group, so this is repeated until nothing is added.
        let mut added = !all;
        while added {
            added = false;
            for at in 0..passes.len() {
                if !runs[groups[at]] && self.has_reason(plan, &passes[at], at, &runs) {
                    runs[groups[at]] = true;
                    added = true;
                }
            }
        }
        (0..passes.len()).map(|at| runs[groups[at]]).collect()
    }

    fn has_reason(&self, plan: &Plan, made: &MadePass, at: usize, runs: &[bool]) -> bool {
        match (plan.conditions.when[at], &made.memory.versions) {
            (When::Always, _) => true,
            (When::Never | When::Follows, _) => false,
            (_, None) => true,
            (When::Once, Some(_)) => false,
            (When::OnChange, Some(seen)) => {
                let inputs = made.memory.inputs.iter().zip(seen);
                let mut changed = inputs.map(|(id, seen)| {
                    self.seen(plan, *id) != *seen
                        || plan.conditions.writers[id.0].is_some_and(|group| runs[group])
                });
                made.memory.stale || changed.any(|changed| changed)
            }
        }
    }

    /// The state of the histories in a frame in which these passes run.
    pub fn histories(&self, plan: &Plan, runs: &[bool]) -> Histories {
        let versions = |(&id, &latest): (&ResourceId, &usize)| {
            let is_written = plan.conditions.writers[id.0].is_some_and(|group| runs[group]);
            let current = if is_written { 1 - latest } else { latest };
            (
                id,
                Versions {
                    current,
                    previous: latest,
                },
            )
        };
        self.latest.iter().map(versions).collect()
    }

    /// Notes that these passes ran.
    pub fn ran(
        &mut self,
        plan: &Plan,
        passes: &mut [MadePass],
        runs: &[bool],
        histories: &Histories,
    ) {
        let before = self.versions.clone();
        for (_, id) in plan.conditions.written.iter().filter(|(at, _)| runs[*at]) {
            self.touch(*id);
        }
        // Only now: what a pass has read and another writes below is another part of the same resource, else they were one group.
        for (at, pass) in passes.iter_mut().enumerate() {
            let remembers = matches!(plan.conditions.when[at], When::Once | When::OnChange);
            if !(runs[at] && remembers) {
                continue;
            }
            let Seen {
                inputs,
                versions,
                stale,
            } = &mut pass.memory;
            let seen = versions.get_or_insert_default();
            seen.clear();
            seen.extend(inputs.iter().map(|id| match plan.resources[id.0].origin {
                Origin::Previous(base) => before[base.0],
                _ => self.versions[id.0],
            }));
            *stale = false;
        }
        for (id, versions) in histories {
            self.latest.insert(*id, versions.current);
        }
    }
}
