//! Decides which passes run in a frame, by the changes since each ran last.
//!
//! A pass need not run again while its inputs are unchanged. Contents are not compared, which would
//! cost more than most passes. Instead every write, and every change that the host reports, gets a
//! new number, and a pass remembers the numbers that it has seen.

use super::pass::GpuPass;
use crate::memory::physical::{PingPong, Versions};
use skiagraph_graph::{Origin, Plan, ResourceId, When};

/// Version numbers of the contents of a plan's resources, and those that its passes have seen.
#[derive(Debug, Default)]
pub(super) struct Contents {
    /// Version of every resource of the plan, by id.
    versions: Vec<u64>,
    clock: u64,
    /// Latest content of each resource with two allocations, in the order of ids.
    latest: Vec<(ResourceId, Written)>,
    /// The provided resources that are read as `.previous`, with their copies; `None` for a copy
    /// that was never filled.
    host_copies: Vec<(HostCopy, Option<Copied>)>,
    /// Versions of the inputs of each pass of the schedule when it ran last; `None` if it has not
    /// run, or its results are lost.
    pub seen: Vec<Option<Vec<u64>>>,
    /// True for each pass whose params or state have changed since it ran.
    pub stale: Vec<bool>,
}

/// A provided resource, and the copy of it that the next frame reads as `.previous`.
pub(super) type HostCopy = (ResourceId, ResourceId);

/// Latest content of a resource with two allocations: the index of its allocation, and the number
/// of the frame that wrote it; 0 if none has.
type Written = (usize, u64);

/// Content of a `.previous` copy of a provided resource: its version, and the number of the frame
/// that copied it first.
type Copied = (u64, u64);

/// Version of a copy whose content is not known: no content has it.
const UNKNOWN: u64 = 0;

/// Copies into the memory that is there: one is made for every frame.
impl Clone for Contents {
    fn clone(&self) -> Self {
        let mut copy = Self::default();
        copy.clone_from(self);
        copy
    }

    fn clone_from(&mut self, other: &Self) {
        self.versions.clone_from(&other.versions);
        self.clock = other.clock;
        self.latest.clone_from(&other.latest);
        self.host_copies.clone_from(&other.host_copies);
        self.seen.clone_from(&other.seen);
        self.stale.clone_from(&other.stale);
    }
}

impl Contents {
    /// Creates the versions of a plan whose resources have no known content.
    pub fn new(plan: &Plan, clock: u64) -> Self {
        let passes = plan.schedule().passes.len();
        let mut contents = Self {
            versions: vec![0; plan.resources().len()],
            clock,
            host_copies: host_copies(plan).map(|copy| (copy, None)).collect(),
            seen: vec![None; passes],
            stale: vec![false; passes],
            ..Self::default()
        };
        for &id in plan.schedule().lifetimes.keys() {
            contents.touch(id);
            if plan.versions(id) > 1 {
                contents.latest.push((id, (0, 0)));
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

    /// Gives a resource the version that the resource `former` has in `other`: it holds the same
    /// content.
    pub fn take_over(&mut self, id: ResourceId, other: &Self, former: ResourceId) {
        self.versions[id.index()] = other.versions[former.index()];
        let latest = self.latest.iter_mut().find(|(latest, _)| *latest == id);
        let before = other.latest.iter().find(|(latest, _)| *latest == former);
        if let (Some((_, latest)), Some((_, before))) = (latest, before) {
            *latest = *before;
        }
        let mut copies = self.host_copies.iter_mut();
        let copied = copies.find(|((_, copy), _)| *copy == id);
        let mut copies_before = other.host_copies.iter();
        let before = copies_before.find(|((_, copy), _)| *copy == former);
        if let (Some((_, copied)), Some((_, before))) = (copied, before) {
            *copied = *before;
        }
    }

    /// Sets `runs` to true for each pass of the schedule that runs. A group runs if one of its
    /// passes has a reason to, or if `forced` is set and its run condition is not false in every
    /// frame. The frame's number counts from 0.
    pub fn running(
        &self,
        plan: &Plan,
        passes: &[GpuPass],
        (frame, forced): (u32, bool),
        runs: &mut Vec<bool>,
    ) {
        let conditions = &plan.schedule().conditions;
        let groups = &conditions.group;
        runs.clear();
        runs.resize(passes.len(), false);
        // All is what could run, not what a param forbids.
        for (&group, when) in groups.iter().zip(&conditions.when) {
            runs[group] |= forced && !matches!(when, When::Never | When::Follows);
        }
        // A pass that runs can be the reason for one before it in its group, so this is repeated
        // until nothing is added.
        let mut added = !forced;
        while added {
            added = false;
            for at in 0..passes.len() {
                if !runs[groups[at]] && self.has_reason(plan, &passes[at], (at, frame), runs) {
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

    fn has_reason(
        &self,
        plan: &Plan,
        pass: &GpuPass,
        (at, frame): (usize, u32),
        runs: &[bool],
    ) -> bool {
        let conditions = &plan.schedule().conditions;
        match (conditions.when[at], &self.seen[at]) {
            (When::Always, _) => true,
            (When::Never | When::Follows, _) => false,
            (When::InTurn, _) => {
                let turns = &plan.pass(plan.schedule().passes[at]).turns;
                turns[frame as usize % turns.len()]
            }
            (_, None) => true,
            (When::Once, Some(_)) => false,
            (When::OnChange, Some(seen)) => {
                let inputs = pass.inputs.iter().zip(seen);
                let mut changed = inputs.map(|(id, seen)| {
                    let now = self.versions[counted(plan, *id).unwrap_or(*id).index()];
                    let resource = (*id, plan.resource(*id).keep);
                    now != *seen || conditions.is_written_before(resource, at, runs)
                });
                self.stale[at] || changed.any(|changed| changed)
            }
        }
    }

    /// Sets the current and previous allocation of each resource with two, for a frame that runs
    /// these passes.
    pub fn ping_pong(&self, plan: &Plan, runs: &[bool], turn: &mut PingPong) {
        let writers = &plan.schedule().conditions.writers;
        // Entries that exist stay in their place: every frame comes here.
        turn.retain(|id, _| self.latest.iter().any(|(resource, _)| resource == id));
        for &(id, (latest, _)) in &self.latest {
            let is_written = writers[id.index()].is_some_and(|group| runs[group]);
            let current = if is_written { 1 - latest } else { latest };
            let previous = latest;
            turn.insert(id, Versions { current, previous });
        }
    }

    /// Notes that these passes ran in the frame with this number, which began with the contents
    /// `before`.
    pub fn ran(
        &mut self,
        plan: &Plan,
        passes: &[GpuPass],
        runs: &[bool],
        (number, before, ping_pong): (u64, &Self, &PingPong),
    ) {
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
        for (at, pass) in passes.iter().enumerate() {
            while let Some(&(_, id)) = kept.next_if(|(by, _)| *by <= at) {
                self.touch(id);
            }
            let remembers = matches!(conditions.when[at], When::Once | When::OnChange);
            if !(runs[at] && remembers) {
                continue;
            }
            let seen = self.seen[at].get_or_insert_default();
            seen.clear();
            // If two allocations take turns, the pass saw the one that the frame began with.
            seen.extend(pass.inputs.iter().map(|id| match counted(plan, *id) {
                Some(base) => before.versions[base.index()],
                None => self.versions[id.index()],
            }));
            self.stale[at] = false;
        }
        for (id, latest) in &mut self.latest {
            let current = ping_pong.get(id).map(|versions| versions.current);
            if let Some(written) = current.filter(|current| *current != latest.0) {
                *latest = (written, number);
            }
        }
    }

    /// Calls `copy` for each `.previous` copy that was never filled, before a frame's first pass:
    /// there was no frame before, so the current content takes its place. The frame has this
    /// number.
    pub fn first_copies(&mut self, number: u64, mut copy: impl FnMut(HostCopy)) {
        for (pair, copied) in &mut self.host_copies {
            copied.get_or_insert_with(|| {
                copy(*pair);
                (self.versions[pair.0.index()], number)
            });
        }
    }

    /// Calls `copy` for each provided resource that has changed since it was last copied, after the
    /// last pass of the frame with this number. What a frame copies that may be lost, from
    /// `pending` on, is copied again.
    pub fn copies(&mut self, number: u64, pending: u64, mut copy: impl FnMut(HostCopy)) {
        for at in 0..self.host_copies.len() {
            let (pair, copied) = self.host_copies[at];
            let version = self.versions[pair.0.index()];
            let valid = copied.filter(|(seen, _)| *seen == version);
            if valid.is_none() {
                self.host_copies[at].1 = Some((version, number));
                self.touch(pair.1);
            }
            if valid.is_none_or(|(_, first)| first >= pending) {
                copy(pair);
            }
        }
    }

    /// True if a content is there only once the frame with this number has run.
    pub fn relies_on(&self, number: u64) -> bool {
        let latest = self.latest.iter().map(|(_, (_, writer))| *writer);
        let copies = self.host_copies.iter().filter_map(|(_, copied)| *copied);
        let mut writers = latest.chain(copies.map(|(_, first)| first));
        writers.any(|writer| writer == number)
    }

    /// Restores the contents before frames that never ran. What the host has changed since then
    /// stays changed.
    pub fn rewind(&mut self, plan: &Plan, before: &Self) {
        let versions = self.versions.iter_mut().zip(&before.versions);
        for (resource, (version, before)) in plan.resources().iter().zip(versions) {
            if resource.origin != Origin::Host {
                *version = *before;
            }
        }
        self.latest.clone_from(&before.latest);
        self.host_copies.clone_from(&before.host_copies);
        self.seen.clone_from(&before.seen);
        for (stale, before) in self.stale.iter_mut().zip(&before.stale) {
            *stale |= before;
        }
    }

    /// Forgets what passes have seen, so that all run again, and what lost frames have written: of
    /// resources with two allocations the latest is that which the last of the others has written.
    /// `frames` has the number of each frame, true if the frame is lost, and the contents before
    /// it, in which the same is forgotten.
    pub fn forget(&mut self, frames: &mut [(u64, bool, &mut Self)]) {
        for at in 0..frames.len() {
            let (until, behind) = frames.split_at_mut(at + 1);
            let (number, true, before) = &until[at] else {
                continue;
            };
            let behind = behind.iter_mut().map(|(_, _, contents)| &mut **contents);
            for contents in behind.chain([&mut *self]) {
                for ((_, written), (_, before)) in contents.latest.iter_mut().zip(&before.latest) {
                    if written.1 == *number {
                        *written = *before;
                    }
                }
            }
        }
        for at in 0..self.host_copies.len() {
            let first = frames.first().map(|(_, _, first)| first.host_copies[at].1);
            let first = first.unwrap_or(self.host_copies[at].1);
            let mut right = first.map(|_| (UNKNOWN, 0));
            for (number, is_lost, before) in &mut *frames {
                before.host_copies[at].1 = right;
                right = right.or((!*is_lost).then_some((UNKNOWN, *number)));
            }
            self.host_copies[at].1 = right;
        }
        self.seen.fill(None);
        for (_, _, before) in frames {
            before.seen.fill(None);
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
