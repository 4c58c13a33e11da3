//! Changes the plan of an executor, for a new viewport, param value or graph, and keeps every part
//! that both plans have in common.
//!
//! A program that changes a param in every frame must not create a pipeline in every frame. A
//! shadow map must not be drawn again because a later pass changed. A plan that the device refuses
//! must leave the former one running. So the new state is built beside the former one, out of its
//! parts, and replaces it when nothing can fail any more. Resources and passes are matched by name,
//! because indices differ between plans.

use super::{contents::Contents, pass::GpuPass, state::State};
use crate::error::ExecuteError;
use crate::memory::memory::Memory;
use crate::pipelines::key::same_pipeline;
use crate::pipelines::pipelines::Pipelines;
use skiagraph_graph::{Ids, LinkedPass, Plan, ResourceId, ResourceKind, step::Step};
use std::collections::{BTreeMap, HashMap};

/// Work that a change of an [`Executor`](super::Executor)'s plan took. Names of passes stand in the
/// order in which the passes run, names of resources in the order of the graph document.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct ReplanReport {
    /// Names of the passes whose uniform buffer `params` was uploaded again with other values; new
    /// passes are not listed.
    pub uploads: Vec<String>,
    /// Names of the new passes, and of the passes that got other pipelines: those with another
    /// shader, target format, `override` constant, or state such as culling or depth bias.
    pub pipelines: Vec<String>,
    /// Names of the textures and buffers of the graph itself (not those of the host) that were
    /// created anew without their former content.
    pub resources: Vec<String>,
}

/// True if all steps of a pass keep their pipelines.
fn has_same_pipelines(old: &LinkedPass, new: &LinkedPass) -> bool {
    let is_same = |(old, new): (&Step<Ids>, &Step<Ids>)| {
        old.program().is_none() && new.program().is_none() || same_pipeline(old, new)
    };
    old.steps.len() == new.steps.len() && old.steps.iter().zip(&new.steps).all(is_same)
}

/// True if all steps of two passes have the same bytes of params.
pub(super) fn has_same_params(old: &LinkedPass, new: &LinkedPass) -> bool {
    old.params().eq(new.params())
}

/// The parts of an executor's state that a new plan keeps.
pub(super) struct Reused<'a> {
    old: &'a State,
    plan: &'a Plan,
    memory: &'a Memory,
    /// Position of each pass in the former schedule; `None` for a new pass.
    pub positions: Vec<Option<usize>>,
    /// Resources that keep their content, with their former ids: same memory, same content in a
    /// larger buffer, or a provided buffer of the same size.
    same: BTreeMap<ResourceId, ResourceId>,
}

impl<'a> Reused<'a> {
    pub fn new(old: &'a State, plan: &'a Plan, memory: &'a Memory) -> Self {
        let passes = old.plan.live().enumerate();
        let positions = passes.map(|(at, pass)| (pass.name.as_str(), at));
        let positions: HashMap<&str, usize> = positions.collect();
        let live = old.plan.schedule().lifetimes.keys();
        let formers = live.map(|id| (old.plan.resource(*id).name.as_str(), *id));
        let formers: HashMap<&str, ResourceId> = formers.collect();
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

    /// Returns the former pass for the pass at position `at`; `None` if it is new.
    fn before(&self, at: usize) -> Option<(&'a LinkedPass, &'a GpuPass)> {
        let position = self.positions[at]?;
        let plan = &self.old.plan;
        let linked = plan.pass(plan.schedule().passes[position]);
        Some((linked, &self.old.passes[position]))
    }

    /// Creates the passes of the plan.
    pub fn passes(&self, pipelines: &Pipelines) -> Result<Vec<GpuPass>, ExecuteError> {
        let _in_use = pipelines.of_passes(self.with_new_pipelines())?;
        let made = |at| GpuPass::new(self.plan, at, self.before(at), pipelines);
        (0..self.positions.len()).map(made).collect()
    }

    /// Returns the names of the passes with new pipelines.
    pub fn made_pipelines(&self) -> Vec<String> {
        let passes = self.with_new_pipelines();
        passes.map(|pass| pass.name.value.clone()).collect()
    }

    fn with_new_pipelines(&self) -> impl Iterator<Item = &'a LinkedPass> {
        let is_new = |at: usize, pass: &LinkedPass| {
            let before = self.before(at);
            before.is_none_or(|(old, _)| !has_same_pipelines(old, pass))
        };
        let passes = self.plan.live().enumerate();
        passes.filter_map(move |(at, pass)| is_new(at, pass).then_some(pass))
    }

    /// Returns the names of the resources whose content is lost.
    pub fn made_resources(&self) -> Vec<String> {
        let schedule = self.plan.schedule();
        let own =
            |id: &&ResourceId| schedule.aliases.of.contains_key(id) && !self.same.contains_key(id);
        let made = schedule.lifetimes.keys().filter(own);
        made.map(|id| self.plan.resource(*id).name.clone())
            .collect()
    }

    /// True if a resource that lasts from frame to frame has new memory.
    pub fn has_new_memory(&self) -> bool {
        let schedule = self.plan.schedule();
        let is_lasting =
            |id: &&ResourceId| self.plan.resource(**id).keep || schedule.ping_pong.contains(*id);
        let mut lasting = schedule.lifetimes.keys().filter(is_lasting);
        lasting.any(|id| !self.same.contains_key(id))
    }

    /// Returns the contents `old` of the former plan, as far as the passes of this one, `made`,
    /// find them.
    pub fn contents(&self, made: &[GpuPass], old: &Contents) -> Contents {
        let mut contents = Contents::new(self.plan, self.old.contents.clock());
        let has_changed = |id: ResourceId, former: ResourceId| {
            self.memory.version(id) != self.old.memory.version(former)
        };
        // A provider may hand out the buffer of before with something else in it.
        let same = self.same.iter();
        for (&id, &former) in same.filter(|(id, former)| !has_changed(**id, **former)) {
            contents.take_over(id, old, former);
        }
        let groups = self.groups();
        let group = &self.plan.schedule().conditions.group;
        for (at, pass) in made.iter().enumerate() {
            if let Some(former) = self.positions[at].filter(|_| groups[group[at]]) {
                contents.seen[at] = self.seen(&pass.inputs, former, old);
            }
            contents.stale[at] = self.bound(at).is_none_or(|former| old.stale[former]);
        }
        contents
    }

    /// Returns the pass at position `at` and its former version, if all its resources are in the
    /// same memory as before; `None` otherwise.
    fn with_its_memory(&self, at: usize) -> Option<[&LinkedPass; 2]> {
        let pass = self.plan.pass(self.plan.schedule().passes[at]);
        let (old, _) = self.before(at)?;
        let mut accesses = pass.accesses.iter().zip(&old.accesses);
        let is_there = pass.accesses.len() == old.accesses.len()
            && accesses.all(|(new, old)| self.same.get(&new.resource) == Some(&old.resource));
        is_there.then_some([pass, old])
    }

    /// Returns for each group, by its first position, true if its passes do the same work as
    /// before, whatever their params. Their results are then still valid.
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

    /// Returns the former position of a pass whose bindings still hold: it is unchanged and uses
    /// the very same memory. `None` if it must be bound again.
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
        let stores_alike = |former: &usize| {
            let now = self.plan.discarded(at);
            same_steps && same_numbers && now == self.old.plan.discarded(*former)
        };
        self.positions[at].filter(stores_alike)
    }

    /// Returns the versions of the inputs that the pass at the position `former` of the former plan
    /// saw when it ran last; `None` if they are not known.
    fn seen(&self, inputs: &[ResourceId], former: usize, old: &Contents) -> Option<Vec<u64>> {
        let former_inputs = self.old.passes[former].inputs.iter();
        let seen = former_inputs.zip(old.seen[former].as_ref()?);
        let seen: BTreeMap<ResourceId, u64> = seen.map(|(id, seen)| (*id, *seen)).collect();
        let version = |id: &ResourceId| seen.get(self.same.get(id)?).copied();
        let versions: Vec<u64> = inputs.iter().map(version).collect::<Option<_>>()?;
        (versions.len() == seen.len()).then_some(versions)
    }
}
