//! Which passes run in a frame, by what changed since they ran last.

use super::pass::MadePass;
use crate::{
    document::Run,
    memory::{Histories, Versions},
    plan::Plan,
    resolve::{Origin, ResourceId},
};
use std::collections::BTreeMap;

/// What the resources of a plan hold, as far as it can be told without looking: every change of content is a new number.
#[derive(Clone, Debug, Default)]
pub(super) struct Contents {
    versions: BTreeMap<ResourceId, u64>,
    clock: u64,
    /// Which of its two allocations holds a resource with a history.
    latest: BTreeMap<ResourceId, usize>,
}

impl Contents {
    /// Contents of a plan of which nothing is known.
    pub fn of(plan: &Plan, clock: u64) -> Self {
        let mut contents = Self {
            clock,
            ..Self::default()
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
        self.versions.insert(id, self.clock);
    }

    /// The content is that which another resource had.
    pub fn take_over(&mut self, id: ResourceId, other: &Self, of: ResourceId) {
        if let Some(version) = other.versions.get(&of) {
            self.versions.insert(id, *version);
        }
        if let Some(latest) = other.latest.get(&of) {
            self.latest.insert(id, *latest);
        }
    }

    /// The version that a pass sees of an input: of what it was in the frame before if it reads that.
    fn seen(&self, plan: &Plan, id: ResourceId) -> u64 {
        let id = match plan.resources[id.0].origin {
            Origin::Previous(base) => base,
            _ => id,
        };
        self.versions.get(&id).copied().unwrap_or(0)
    }

    /// Whether each pass of the schedule runs. A group runs if one of its passes has a reason to.
    pub fn running(&self, plan: &Plan, passes: &[MadePass], all: bool) -> Vec<bool> {
        let groups = &plan.conditions.group;
        // All is what could run, not what a param forbids.
        let allowed = |&pass: &usize| {
            let pass = &plan.passes[pass];
            all && (pass.enabled || !matches!(pass.run, Run::When(_)))
        };
        let mut runs: Vec<bool> = plan.schedule.iter().map(allowed).collect();
        let mut writers: BTreeMap<ResourceId, usize> = BTreeMap::new();
        for (at, &pass) in plan.schedule.iter().enumerate() {
            let accesses = &plan.passes[pass].accesses;
            for access in accesses.iter().filter(|access| access.writes) {
                writers.insert(access.resource, groups[at]);
            }
        }
        // A pass that runs can be the reason for one before it in its group, so this is repeated until nothing is added.
        let mut added = !all;
        while added {
            added = false;
            for at in 0..passes.len() {
                if !runs[groups[at]] && self.has_reason(plan, &passes[at], at, &runs, &writers) {
                    runs[groups[at]] = true;
                    added = true;
                }
            }
        }
        (0..passes.len()).map(|at| runs[groups[at]]).collect()
    }

    fn has_reason(
        &self,
        plan: &Plan,
        made: &MadePass,
        at: usize,
        runs: &[bool],
        writers: &BTreeMap<ResourceId, usize>,
    ) -> bool {
        let pass = &plan.passes[plan.schedule[at]];
        match (&pass.run, &made.memory.versions) {
            (Run::Always, _) => true,
            (Run::When(_), _) => pass.enabled,
            (_, None) => true,
            (Run::Once, Some(_)) => false,
            (Run::OnChange, Some(seen)) => {
                let inputs = made.memory.inputs.iter().zip(seen);
                let mut changed = inputs.map(|(id, seen)| {
                    self.seen(plan, *id) != *seen
                        || writers.get(id).is_some_and(|&writer| runs[writer])
                });
                made.memory.stale || changed.any(|changed| changed)
            }
        }
    }

    /// The state of the histories in a frame in which these passes run.
    pub fn histories(&self, plan: &Plan, runs: &[bool]) -> Histories {
        let versions = |(&id, &latest): (&ResourceId, &usize)| {
            let is_written = plan.schedule.iter().zip(runs).any(|(&pass, runs)| {
                let accesses = &plan.passes[pass].accesses;
                *runs
                    && accesses
                        .iter()
                        .any(|access| access.writes && access.resource == id)
            });
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
        let before = self.clone();
        for (at, &pass) in plan.schedule.iter().enumerate().filter(|(at, _)| runs[*at]) {
            let version = |id: &ResourceId| match plan.resources[id.0].origin {
                Origin::Previous(_) => before.seen(plan, *id),
                _ => self.seen(plan, *id),
            };
            passes[at].memory.stale = false;
            passes[at].memory.versions =
                Some(passes[at].memory.inputs.iter().map(version).collect());
            for access in plan.passes[pass]
                .accesses
                .iter()
                .filter(|access| access.writes)
            {
                self.touch(access.resource);
            }
        }
        for (id, versions) in histories {
            self.latest.insert(*id, versions.current);
        }
    }
}
