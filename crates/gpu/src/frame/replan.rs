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
    executor::{Executor, check_backend},
    fetch::Readable,
    growth_readback::GrowthReadback,
    pass::{GpuPass, InputVersions},
    poison::Poison,
    state::{State, frame_uniform},
};
use crate::{
    error::{ExecuteError, with_table},
    memory::memory::{Memory, ResourceFactory},
    pipelines::pipelines::{Pipelines, same_pipeline},
    provider::Provider,
};
use skiagraph_graph::{Ids, LinkedPass, ParamValue, Plan, ResourceId, ResourceKind, step::Step};
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

impl Executor {
    /// Another viewport. Textures that follow it are made anew: last frame's versions are zero
    /// again, and passes that keep their outputs run once more.
    ///
    /// # Errors
    /// If the graph cannot be planned for this viewport or the device refuses something. The
    /// executor is as it was then.
    pub fn resize(
        &mut self,
        viewport: [u32; 2],
        provider: &mut dyn Provider,
    ) -> Result<ReplanReport, ExecuteError> {
        let plan = self.plan().with_viewport(viewport)?;
        self.replace_graph(plan, provider)
    }

    /// Another value of a param. One that only `var<uniform> params` reads costs an upload. For all
    /// others the graph is planned anew; from what comes out otherwise than before follows what it
    /// costs:
    ///
    /// - one that is an `override` constant, a culling mode, a depth bias or the like: new
    ///   pipelines of these passes;
    /// - one that sizes, counts or `repeat`s something, or that an `if` reads: new resources and
    ///   passes, and whatever follows from them;
    /// - one of `run: When(…)`: nothing.
    ///
    /// # Errors
    /// If there is no such param, its value is out of range, or the graph cannot be planned with
    /// it; if what the provider has changed cannot be had. The executor is as it was then.
    pub fn set_param(
        &mut self,
        name: &str,
        value: ParamValue,
        provider: &mut dyn Provider,
    ) -> Result<ReplanReport, ExecuteError> {
        if !self.plan().is_in_uniforms(name, &value) {
            let plan = self.plan().with_param(name, value)?;
            return self.replace_graph(plan, provider);
        }
        self.presence.check()?;
        self.refresh(provider)?;
        let state = &mut self.state;
        let before = state.plan.param(name).cloned();
        let changed = state.plan.set_in_uniforms(name, value);
        let params = changed.iter().map(|&at| {
            let pass = state.plan.pass(state.plan.schedule().passes[at]);
            GpuPass::params_of(pass, &self.device)
        });
        let params = match params.collect::<Result<Vec<_>, _>>() {
            Ok(params) => params,
            Err(error) => {
                if let Some(before) = before {
                    state.plan.set_in_uniforms(name, before);
                }
                return Err(with_table(error, &state.plan));
            }
        };
        let mut report = ReplanReport::default();
        for (at, params) in changed.into_iter().zip(params) {
            let pass = &mut state.passes[at];
            pass.set_params(params);
            report.uploads.push(pass.name.to_string());
        }
        Ok(report)
    }

    /// Another plan: of the same graph, of one that was loaded again, or of any other. Pipelines,
    /// textures and buffers that are the same in both are kept, those of the provider and the
    /// imports included.
    ///
    /// # Errors
    /// If the device refuses something. The executor is as it was then.
    pub fn replace_graph(
        &mut self,
        plan: Plan,
        provider: &mut dyn Provider,
    ) -> Result<ReplanReport, ExecuteError> {
        let report = self.put_in(plan, provider)?;
        self.note_changes(provider);
        Ok(report)
    }

    /// [`replace_graph`](Self::replace_graph), but for the flags of the uniform `frame`.
    pub(super) fn put_in(
        &mut self,
        plan: Plan,
        provider: &mut dyn Provider,
    ) -> Result<ReplanReport, ExecuteError> {
        self.presence.check()?;
        check_backend(&self.device, &plan)?;
        let mut factory = ResourceFactory {
            device: &self.device,
            queue: &self.queue,
            provider,
        };
        let memory = Memory::new(
            &plan,
            Some((&self.state.plan, &self.state.memory)),
            &mut factory,
        );
        let mut memory = memory.map_err(|error| with_table(error, &plan))?;
        let reused = Reused::new(&self.state, &plan, &memory);
        let made = reused.passes(&mut self.pipelines, &self.device);
        let passes = made.map_err(|error| with_table(error, &plan))?;
        let mut report = ReplanReport {
            pipelines: reused.made_pipelines(),
            resources: reused.made_resources(),
            ..ReplanReport::default()
        };
        let contents = reused.contents();
        let has_new_memory = reused.has_new_memory();
        let bound: Vec<Option<usize>> = (0..passes.len()).map(|at| reused.bound(at)).collect();
        let positions = reused.positions;
        let poison = Poison::new(&plan, &memory, &self.device);
        let growth_readbacks = GrowthReadback::all(&plan, &self.device);
        let mut state = State {
            growth_readbacks: growth_readbacks.map_err(|error| with_table(error, &plan))?,
            poison: poison.map_err(|error| with_table(error, &plan))?,
            readables: Readable::all(&plan),
            uniform: frame_uniform(&plan),
            grown: memory.take_grown(),
            plan,
            memory,
            passes,
            contents,
        };
        // A pass whose resources are all the same is bound already.
        let rebind = |from: &mut State, to: &mut State, back: bool| {
            for (new, old) in bound.iter().enumerate() {
                match old {
                    Some(old) if back => to.passes[*old].rebind_as(&mut from.passes[new]),
                    Some(old) => to.passes[new].rebind_as(&mut from.passes[*old]),
                    None => {}
                }
            }
        };
        rebind(&mut self.state, &mut state, false);
        if let Err(error) = state.bind_what_can_be(&self.device) {
            rebind(&mut state, &mut self.state, true);
            return Err(error);
        }
        let mut before = std::mem::replace(&mut self.state, state);
        GrowthReadback::take_over(
            &mut self.state.growth_readbacks,
            std::mem::take(&mut before.growth_readbacks),
        );
        // Content due for a buffer that has grown again is copied on from there.
        self.state.grown.splice(..0, before.grown);
        if has_new_memory {
            self.host_changes.note_new_memory();
        }
        self.ping_pong = self.state.ping_pong(false);
        self.frames_in_flight.staging.clear();
        report.uploads = self.note_params(&before.plan, &positions);
        Ok(report)
    }

    /// The passes that were made with other params than those of before; such a pass counts as
    /// changed.
    fn note_params(&mut self, before: &Plan, positions: &[Option<usize>]) -> Vec<String> {
        let mut uploads = Vec::new();
        let schedule = self.state.plan.live().zip(positions);
        for ((pass, position), made) in schedule.zip(&mut self.state.passes) {
            let Some(position) = *position else {
                continue;
            };
            let old = before.pass(before.schedule().passes[position]);
            if !has_same_params(old, pass) {
                made.input_versions.stale = true;
                uploads.push(pass.name.value.clone());
            }
        }
        uploads
    }
}

/// Returns true if all steps of a pass have the pipelines that they had.
fn has_same_pipelines(old: &LinkedPass, new: &LinkedPass) -> bool {
    let is_same = |(old, new): (&Step<Ids>, &Step<Ids>)| {
        old.program().is_none() && new.program().is_none() || same_pipeline(old, new)
    };
    old.steps.len() == new.steps.len() && old.steps.iter().zip(&new.steps).all(is_same)
}

/// Returns true if all steps of a pass have the bytes of params that they had.
fn has_same_params(old: &LinkedPass, new: &LinkedPass) -> bool {
    old.params().eq(new.params())
}

/// Parts of an executor's state that a new plan keeps.
struct Reused<'a> {
    old: &'a State,
    plan: &'a Plan,
    memory: &'a Memory,
    /// Former position of each pass of the plan.
    positions: Vec<Option<usize>>,
    /// The resources that are in the memory that they were in before, or go on with its content in
    /// a larger buffer, or are the provider's and as large as before; and what they were then.
    same: BTreeMap<ResourceId, ResourceId>,
}

impl<'a> Reused<'a> {
    fn new(old: &'a State, plan: &'a Plan, memory: &'a Memory) -> Self {
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
    fn passes(
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
    fn made_pipelines(&self) -> Vec<String> {
        let passes = self.plan.live().enumerate();
        let made = passes.filter(|(at, pass)| {
            self.before(*at)
                .is_none_or(|(old, _)| !has_same_pipelines(old, pass))
        });
        made.map(|(_, pass)| pass.name.value.clone()).collect()
    }

    /// Names of the resources whose content is lost.
    fn made_resources(&self) -> Vec<String> {
        let schedule = self.plan.schedule();
        let own =
            |id: &&ResourceId| schedule.aliases.of.contains_key(id) && !self.same.contains_key(id);
        let made = schedule.lifetimes.keys().filter(own);
        made.map(|id| self.plan.resource(*id).name.clone())
            .collect()
    }

    /// Returns true if something that stays from frame to frame is in new memory.
    fn has_new_memory(&self) -> bool {
        let schedule = self.plan.schedule();
        let is_lasting =
            |id: &&ResourceId| self.plan.resource(**id).keep || schedule.ping_pong.contains(*id);
        let mut lasting = schedule.lifetimes.keys().filter(is_lasting);
        lasting.any(|id| !self.same.contains_key(id))
    }

    fn contents(&self) -> Contents {
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
    fn bound(&self, at: usize) -> Option<usize> {
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
