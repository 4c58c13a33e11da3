//! Decides which passes run in a frame, by the changes since each ran last.
//!
//! A pass need not run again while its inputs are unchanged. Contents are not compared, which would
//! cost more than most passes. Instead every write, and every change that the host reports, gets a
//! new number, and a pass remembers the numbers that it has seen.

use super::pass::{GpuPass, InputVersions};
use crate::memory::physical::{PingPong, Versions};
use skiagraph_graph::{Origin, Plan, ResourceId, When};
use std::collections::BTreeMap;

/// Version numbers of the contents of a plan's resources.
#[derive(Clone, Debug, Default)]
pub(super) struct Contents {
    /// Version of every resource of the plan, by id.
    versions: Vec<u64>,
    clock: u64,
    /// Index of the allocation with the latest content, for each resource with two allocations.
    latest: BTreeMap<ResourceId, usize>,
    /// Version of the content in each `.previous` copy of a provided resource.
    copied: BTreeMap<ResourceId, u64>,
    /// The provided resources that are read as `.previous`, with their copies.
    host_copies: Vec<HostCopy>,
    /// Versions before the frame.
    before: Vec<u64>,
}

/// A provided resource, and the copy of it that the next frame reads as `.previous`.
pub(super) type HostCopy = (ResourceId, ResourceId);

impl Contents {
    /// Creates the versions of a plan whose resources have no known content.
    pub fn new(plan: &Plan, clock: u64) -> Self {
        let mut contents = Self {
            versions: vec![0; plan.resources().len()],
            clock,
            host_copies: host_copies(plan).collect(),
            ..Self::default()
        };
        for &id in plan.schedule().lifetimes.keys() {
            contents.touch(id);
            if plan.versions(id) > 1 {
                contents.latest.insert(id, 0);
            }
        }
        contents
    }

    /// Returns the number of the last change.
    pub fn clock(&self) -> u64 {
        self.clock
    }

    /// Gives a resource a new version: its content has changed.
    pub fn touch(&mut self, id: ResourceId) {
        self.clock += 1;
        self.versions[id.index()] = self.clock;
    }

    /// Gives a resource the version that the resource `of` has in `other`: it holds the same
    /// content.
    pub fn take_over(&mut self, id: ResourceId, other: &Self, of: ResourceId) {
        self.versions[id.index()] = other.versions[of.index()];
        if let Some(latest) = other.latest.get(&of) {
            self.latest.insert(id, *latest);
        }
        if let Some(copied) = other.copied.get(&of) {
            self.copied.insert(id, *copied);
        }
    }

    /// Sets `runs` to true for each pass of the schedule that runs. A group runs if one of its
    /// passes has a reason to, or if `all` is set and its run condition is not false.
    pub fn running(&self, plan: &Plan, passes: &[GpuPass], all: bool, runs: &mut Vec<bool>) {
        let conditions = &plan.schedule().conditions;
        let groups = &conditions.group;
        runs.clear();
        runs.resize(passes.len(), false);
        // All is what could run, not what a param forbids.
        for (&group, when) in groups.iter().zip(&conditions.when) {
            runs[group] |= all && !matches!(when, When::Never | When::Follows);
        }
        // A pass that runs can be the reason for one before it in its group, so this is repeated
        // until nothing is added.
        let mut added = !all;
        while added {
            added = false;
            for at in 0..passes.len() {
                if !runs[groups[at]] && self.has_reason(plan, &passes[at], at, runs) {
                    runs[groups[at]] = true;
                    added = true;
                }
            }
        }
        // A group is known by its first pass.
        for at in 0..passes.len() {
            runs[at] = runs[groups[at]];
        }
    }

    fn has_reason(&self, plan: &Plan, pass: &GpuPass, at: usize, runs: &[bool]) -> bool {
        let conditions = &plan.schedule().conditions;
        match (conditions.when[at], &pass.input_versions.versions) {
            (When::Always, _) => true,
            (When::Never | When::Follows, _) => false,
            (_, None) => true,
            (When::Once, Some(_)) => false,
            (When::OnChange, Some(seen)) => {
                let inputs = pass.input_versions.inputs.iter().zip(seen);
                let mut changed = inputs.map(|(id, seen)| {
                    let now = self.versions[counted(plan, *id).unwrap_or(*id).index()];
                    let resource = (*id, plan.resource(*id).keep);
                    now != *seen || conditions.is_written_before(resource, at, runs)
                });
                pass.input_versions.stale || changed.any(|changed| changed)
            }
        }
    }

    /// Sets the current and previous allocation of each resource with two, for a frame that runs
    /// these passes.
    pub fn ping_pong(&self, plan: &Plan, runs: &[bool], turn: &mut PingPong) {
        let writers = &plan.schedule().conditions.writers;
        // Entries that exist stay in their place: every frame comes here.
        turn.retain(|id, _| self.latest.contains_key(id));
        for (&id, &latest) in &self.latest {
            let is_written = writers[id.index()].is_some_and(|group| runs[group]);
            let current = if is_written { 1 - latest } else { latest };
            let previous = latest;
            turn.insert(id, Versions { current, previous });
        }
    }

    /// Notes that these passes ran.
    pub fn ran(
        &mut self,
        plan: &Plan,
        passes: &mut [GpuPass],
        runs: &[bool],
        ping_pong: &PingPong,
    ) {
        self.before.clone_from(&self.versions);
        let conditions = &plan.schedule().conditions;
        let is_kept = |id: ResourceId| plan.resource(id).keep;
        let written = conditions.written.iter().filter(|(at, _)| runs[*at]);
        for &(_, id) in written.clone().filter(|(_, id)| !is_kept(*id)) {
            self.touch(id);
        }
        // Only now: what a pass has read and another writes below is another part of the same
        // resource, else they were one group. A pass with `keep` has read its material as it was in
        // its place.
        let mut kept = written.filter(|(_, id)| is_kept(*id)).peekable();
        for (at, pass) in passes.iter_mut().enumerate() {
            while let Some(&(_, id)) = kept.next_if(|(by, _)| *by <= at) {
                self.touch(id);
            }
            let remembers = matches!(conditions.when[at], When::Once | When::OnChange);
            if !(runs[at] && remembers) {
                continue;
            }
            let InputVersions {
                inputs,
                versions,
                stale,
            } = &mut pass.input_versions;
            let seen = versions.get_or_insert_default();
            seen.clear();
            // If two allocations take turns, the pass saw the one that the frame began with.
            seen.extend(inputs.iter().map(|id| match counted(plan, *id) {
                Some(base) => self.before[base.index()],
                None => self.versions[id.index()],
            }));
            *stale = false;
        }
        for (id, versions) in ping_pong {
            self.latest.insert(*id, versions.current);
        }
    }

    /// Calls `copy` for each `.previous` copy that was never filled, before a frame's first pass:
    /// there was no frame before, so the current content takes its place.
    pub fn first_copies(&mut self, mut copy: impl FnMut(HostCopy)) {
        for &(base, of_base) in &self.host_copies {
            self.copied.entry(of_base).or_insert_with(|| {
                copy((base, of_base));
                self.versions[base.index()]
            });
        }
    }

    /// Calls `copy` for each provided resource that has changed since it was last copied, after a
    /// frame's last pass.
    pub fn copies(&mut self, mut copy: impl FnMut(HostCopy)) {
        for at in 0..self.host_copies.len() {
            let (base, of_base) = self.host_copies[at];
            let version = self.versions[base.index()];
            if self.copied.insert(of_base, version) != Some(version) {
                self.touch(of_base);
                copy((base, of_base));
            }
        }
    }
}

/// Returns the resource whose version counts for a `.previous` resource with two alternating
/// allocations. `None` for other resources; `.previous` copies of provided ones have versions of
/// their own.
fn counted(plan: &Plan, id: ResourceId) -> Option<ResourceId> {
    match plan.resource(id).origin {
        Origin::Previous(base) if plan.resource(base).origin == Origin::Own => Some(base),
        _ => None,
    }
}

/// Returns the provided resources that a live pass reads as `.previous`, with their copies.
fn host_copies(plan: &Plan) -> impl Iterator<Item = HostCopy> + '_ {
    let copy = |id: &ResourceId| match plan.resource(*id).origin {
        Origin::Previous(base) if plan.resource(base).origin == Origin::Host => Some((base, *id)),
        _ => None,
    };
    plan.schedule().lifetimes.keys().filter_map(copy)
}
