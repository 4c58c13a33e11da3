//! Another plan on the same device: a new size, another value of a param, another graph. Everything
//! that can be kept is kept.
//!
//! Why it is kept matters: a program that changes a param in every frame must not make a pipeline
//! in every frame, a shadow map that a later pass does not touch must not be drawn again, and a
//! plan that the device refuses must leave the program with the one that ran. So another plan is
//! made beside the one that is there, out of its parts, and takes its place when nothing can fail
//! any more. Resources and passes are known by their names, for numbers mean something else in
//! another plan.

use super::{
    contents::Contents,
    pass::{GpuPass, InputVersions},
    state::State,
};
use crate::{
    error::ExecuteError,
    memory::memory::Memory,
    pipelines::pipelines::{Pipelines, same_pipeline},
};
use skiagraph_graph::{Ids, LinkedPass, Plan, ResourceId, ResourceKind, step::Step};
use std::collections::{BTreeMap, HashMap};

/// Result of a change of an executor's plan.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ReplanReport {
    /// Passes whose params were uploaded.
    pub uploads: Vec<String>,
    /// Passes that got new pipelines: another shader, format, constant or state; or passes that
    /// were not there before.
    pub pipelines: Vec<String>,
    /// Textures and buffers that were made anew; their content is lost.
    pub resources: Vec<String>,
}

/// Returns true if all steps of a pass have the pipelines that they had.
fn has_same_pipelines(old: &LinkedPass, new: &LinkedPass) -> bool {
    let is_same = |(old, new): (&Step<Ids>, &Step<Ids>)| {
        old.program().is_none() && new.program().is_none() || same_pipeline(old, new)
    };
    old.steps.len() == new.steps.len() && old.steps.iter().zip(&new.steps).all(is_same)
}

/// Returns true if all steps of a pass have the bytes of params that they had.
pub(super) fn has_same_params(old: &LinkedPass, new: &LinkedPass) -> bool {
    old.params().eq(new.params())
}

/// Parts of an executor's state that a new plan keeps.
pub(super) struct Reused<'a> {
    old: &'a State,
    plan: &'a Plan,
    memory: &'a Memory,
    /// Former position of each pass of the plan.
    pub positions: Vec<Option<usize>>,
    /// The resources that are in the memory that they were in before, or go on with its content in
    /// a larger buffer, or are the provider's and as large as before; and what they were then.
    same: BTreeMap<ResourceId, ResourceId>,
}

impl<'a> Reused<'a> {
    pub fn new(old: &'a State, plan: &'a Plan, memory: &'a Memory) -> Self {
        let positions: HashMap<&str, usize> = old
            .plan
            .live()
            .enumerate()
            .map(|(at, pass)| (pass.name.as_str(), at))
            .collect();
        let formers: HashMap<&str, ResourceId> = old
            .plan
            .schedule()
            .lifetimes
            .keys()
            .map(|id| (old.plan.resource(*id).name.as_str(), *id))
            .collect();
        let same = plan.schedule().lifetimes.keys().filter_map(|&id| {
            let resource = plan.resource(id);
            let former = *formers.get(resource.name.as_str())?;
            let is_same = match (&resource.kind, &old.plan.resource(former).kind) {
                (ResourceKind::Sampler(a), ResourceKind::Sampler(b)) => a == b,
                // Another content is another buffer, as versions tell: no memory is lost by that.
                (ResourceKind::Provided(_), ResourceKind::Provided(_))
                    if Memory::is_alike(memory.host(id), old.memory.host(former)) =>
                {
                    true
                }
                _ => memory.same(id, &old.memory, former) || memory.is_grown(id),
            };
            is_same.then_some((id, former))
        });
        let position = |pass: &LinkedPass| positions.get(pass.name.as_str()).copied();
        Self {
            old,
            plan,
            memory,
            positions: plan.live().map(position).collect(),
            same: same.collect(),
        }
    }

    /// Returns the former state of the pass at `at`.
    fn before(&self, at: usize) -> Option<(&'a LinkedPass, &'a GpuPass)> {
        let position = self.positions[at]?;
        let linked = self
            .old
            .plan
            .pass(self.old.plan.schedule().passes[position]);
        Some((linked, &self.old.passes[position]))
    }

    /// The passes of the plan, with what they remember of frames before.
    pub fn passes(
        &self,
        pipelines: &mut Pipelines,
        device: &wgpu::Device,
    ) -> Result<Vec<GpuPass>, ExecuteError> {
        let groups = self.groups();
        let make = |(at, group): (usize, &usize)| {
            let mut pass = GpuPass::new(self.plan, at, self.before(at), pipelines, device)?;
            if let Some((_, old)) = self.before(at).filter(|_| groups[*group]) {
                pass.input_versions.versions =
                    self.seen(&pass.input_versions.inputs, &old.input_versions);
            }
            let bound = self.bound(at);
            pass.input_versions.stale =
                bound.is_none_or(|before| self.old.passes[before].input_versions.stale);
            Ok(pass)
        };
        let groups = &self.plan.schedule().conditions.group;
        groups.iter().enumerate().map(make).collect()
    }

    /// Names of the passes whose pipelines are not what they were.
    pub fn made_pipelines(&self) -> Vec<String> {
        let passes = self.plan.live().enumerate();
        let made = passes.filter(|(at, pass)| {
            self.before(*at)
                .is_none_or(|(old, _)| !has_same_pipelines(old, pass))
        });
        made.map(|(_, pass)| pass.name.value.clone()).collect()
    }

    /// Names of the resources whose content is lost.
    pub fn made_resources(&self) -> Vec<String> {
        let schedule = self.plan.schedule();
        let own =
            |id: &&ResourceId| schedule.aliases.of.contains_key(id) && !self.same.contains_key(id);
        let made = schedule.lifetimes.keys().filter(own);
        made.map(|id| self.plan.resource(*id).name.clone())
            .collect()
    }

    /// Returns true if something that stays from frame to frame is in new memory.
    pub fn has_new_memory(&self) -> bool {
        let schedule = self.plan.schedule();
        let is_lasting =
            |id: &&ResourceId| self.plan.resource(**id).keep || schedule.ping_pong.contains(*id);
        let mut lasting = schedule.lifetimes.keys().filter(is_lasting);
        lasting.any(|id| !self.same.contains_key(id))
    }

    pub fn contents(&self) -> Contents {
        let mut contents = Contents::new(self.plan, self.old.contents.clock());
        let has_changed = |id: ResourceId, former: ResourceId| {
            self.memory.version(id) != self.old.memory.version(former)
        };
        for (&id, &former) in &self.same {
            // A provider may hand out the buffer of before with something else in it.
            if has_changed(id, former) {
                continue;
            }
            contents.take_over(id, &self.old.contents, former);
        }
        contents
    }

    /// The pass at `at`, and what it was before, if everything that it uses is in the memory that
    /// it was in before.
    fn with_its_memory(&self, at: usize) -> Option<[&LinkedPass; 2]> {
        let pass = self.plan.pass(self.plan.schedule().passes[at]);
        let (old, _) = self.before(at)?;
        let is_there = pass.accesses.len() == old.accesses.len()
            && pass
                .accesses
                .iter()
                .zip(&old.accesses)
                .all(|(new, old)| self.same.get(&new.resource) == Some(&old.resource));
        is_there.then_some([pass, old])
    }

    /// Tells of each group if its passes still do the same, whatever their params. Then what they
    /// made is still there.
    fn groups(&self) -> Vec<bool> {
        let shader = |step: &Step<Ids>| step.program().map(|program| program.shader.clone());
        let is_kept = |[pass, old]: [&LinkedPass; 2]| {
            let shaders = pass.steps.iter().map(shader);
            shaders.eq(old.steps.iter().map(shader))
        };
        let now = &self.plan.schedule().conditions.group;
        let before = &self.old.plan.schedule().conditions.group;
        let mut reused = vec![true; now.len()];
        // Former number of each group.
        let mut former: Vec<Option<usize>> = vec![None; now.len()];
        let mut is_there = vec![false; before.len()];
        for (at, &group) in now.iter().enumerate() {
            reused[group] &= self.with_its_memory(at).is_some_and(is_kept);
            if let Some(position) = self.positions[at] {
                let was = before[position];
                reused[group] &= *former[group].get_or_insert(was) == was;
                is_there[position] = true;
            }
        }
        // If a pass of the group is gone, its results would be left in the output of the others; a
        // capture leaves nothing.
        let mut gone = vec![false; before.len()];
        for (position, pass) in self.old.plan.live().enumerate() {
            gone[before[position]] |= !is_there[position] && !pass.is_capture();
        }
        for (reused, former) in reused.iter_mut().zip(former) {
            *reused &= former.is_none_or(|group| !gone[group]);
        }
        reused
    }

    /// The position before of a pass that needs no binding: word for word what it was, on the very
    /// memory.
    pub fn bound(&self, at: usize) -> Option<usize> {
        let [pass, old] = self.with_its_memory(at)?;
        let mut numbers = pass.accesses.iter().zip(&old.accesses);
        let same_numbers = numbers.all(|(new, old)| {
            let (id, former) = (new.resource, old.resource);
            id == former
                && !self.memory.is_grown(id)
                && self.memory.host(id) == self.old.memory.host(former)
        });
        let same_steps = pass.steps == old.steps && has_same_params(old, pass);
        self.positions[at].filter(|_| same_steps && same_numbers)
    }

    /// Returns the versions of its inputs that a pass saw when it ran last.
    fn seen(&self, inputs: &[ResourceId], old: &InputVersions) -> Option<Vec<u64>> {
        let seen = old.inputs.iter().zip(old.versions.as_ref()?);
        let seen: BTreeMap<ResourceId, u64> = seen.map(|(id, seen)| (*id, *seen)).collect();
        let of = |id: &ResourceId| seen.get(self.same.get(id)?).copied();
        let versions: Vec<u64> = inputs.iter().map(of).collect::<Option<_>>()?;
        (versions.len() == seen.len()).then_some(versions)
    }
}
