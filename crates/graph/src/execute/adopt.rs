//! Another plan on the same device: a new size, another value of a param, another graph. What can be kept is kept.

use super::{
    ExecuteError, Executor,
    error::with_table,
    incremental::Contents,
    pass::{MadePass, Seen},
    poison::Poison,
};
use crate::{
    allocate::{Pipelines, same_pipeline},
    document::params::ParamValue,
    link::{LinkedPass, LinkedStep},
    memory::Memory,
    plan::{CAPTURE, Plan},
    provider::Provider,
    resolve::{ResourceId, ResourceKind},
};
use std::collections::{BTreeMap, HashMap};

/// What a change of an executor's plan came to.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Renewed {
    /// Passes whose params were uploaded.
    pub uploads: Vec<String>,
    /// Passes that got new pipelines: another shader, format, constant or state; or passes that were not there before.
    pub pipelines: Vec<String>,
    /// Textures and buffers that were made anew; their content is lost.
    pub resources: Vec<String>,
}

impl Executor {
    /// Another viewport. Textures that follow it are made anew: last frame's versions are zero again, and passes that keep their
    /// outputs run once more.
    ///
    /// # Errors
    /// If the graph cannot be planned for this viewport or the device refuses something. The executor is as it was then.
    pub fn resize(
        &mut self,
        viewport: [u32; 2],
        provider: &mut dyn Provider,
    ) -> Result<Renewed, ExecuteError> {
        let plan = self.plan.with_viewport(viewport)?;
        self.replace_graph(plan, provider)
    }

    /// Another value of a param. The graph is planned anew; from what comes out otherwise than before follows what it costs:
    ///
    /// - a param that only `var<uniform> params` reads: an upload;
    /// - one that is an `override` constant, a culling mode, a depth bias or the like: new pipelines of these passes;
    /// - one that sizes, counts or `repeat`s something: new resources, and whatever follows from them;
    /// - one of `run: When(…)`: nothing.
    ///
    /// # Errors
    /// If there is no such param, its value is out of range, or the graph cannot be planned with it. The executor is as it was
    /// then.
    pub fn set_param(
        &mut self,
        name: &str,
        value: ParamValue,
        provider: &mut dyn Provider,
    ) -> Result<Renewed, ExecuteError> {
        let plan = self.plan.with_param(name, value)?;
        self.replace_graph(plan, provider)
    }

    /// Another plan: of the same graph, of one that was loaded again, or of any other. Pipelines, textures and buffers that are the
    /// same in both are kept, those of the provider and the imports included.
    ///
    /// # Errors
    /// If the device refuses something. The executor is as it was then.
    pub fn replace_graph(
        &mut self,
        plan: Plan,
        provider: &mut dyn Provider,
    ) -> Result<Renewed, ExecuteError> {
        super::alive(&self.device)?;
        let mut pipelines = std::mem::take(&mut self.pipelines);
        let made = self.prepare(&plan, &mut pipelines, provider);
        self.pipelines = pipelines;
        let Prepared {
            memory,
            contents,
            poison,
            passes,
            positions,
            bound,
            mut renewed,
        } = made.map_err(|error| with_table(error, &plan))?;
        // Everything that can fail has been done but binding; a pass whose resources are all the same is bound already.
        let before = std::mem::replace(&mut self.plan, plan);
        let old_memory = std::mem::replace(&mut self.memory, memory);
        let mut old_passes = std::mem::replace(&mut self.passes, passes);
        let old_contents = std::mem::replace(&mut self.contents, contents);
        let old_poison = std::mem::replace(&mut self.poison, poison);
        for (pass, bound) in self.passes.iter_mut().zip(&bound) {
            if let Some(at) = bound {
                pass.rebind_as(&mut old_passes[*at]);
            }
        }
        if let Err(error) = self.bind_what_can_be() {
            for (pass, bound) in self.passes.iter_mut().zip(&bound) {
                if let Some(at) = bound {
                    old_passes[*at].rebind_as(pass);
                }
            }
            (self.plan, self.memory, self.passes) = (before, old_memory, old_passes);
            (self.contents, self.poison) = (old_contents, old_poison);
            return Err(error);
        }
        self.histories = self
            .contents
            .histories(&self.plan, &vec![false; self.passes.len()]);
        renewed.uploads = self.upload(&before, &positions);
        Ok(renewed)
    }

    /// Everything that another plan needs, made without a change to the executor.
    fn prepare(
        &self,
        plan: &Plan,
        pipelines: &mut Pipelines,
        provider: &mut dyn Provider,
    ) -> Result<Prepared, ExecuteError> {
        let old = Some((&self.plan, &self.memory));
        let memory = Memory::new(plan, old, &self.device, &self.queue, provider)?;
        let kept = Kept::new(self, plan, &memory);
        let mut renewed = Renewed {
            resources: kept.renewed(),
            ..Renewed::default()
        };
        let before = |at: usize| {
            let old = kept.positions[at]?;
            let linked = &self.plan.passes[self.plan.schedule[old]];
            Some((linked, &self.passes[old]))
        };
        let mut passes = (0..plan.schedule.len())
            .map(|at| MadePass::new(plan, at, before(at), pipelines, &self.device))
            .collect::<Result<Vec<_>, _>>()?;
        let bound: Vec<Option<usize>> = (0..passes.len()).map(|at| kept.bound(at)).collect();
        let groups = kept.groups();
        for (at, pass) in passes.iter_mut().enumerate() {
            let is_kept = groups[plan.conditions.group[at]];
            if let Some((_, old)) = before(at).filter(|_| is_kept) {
                pass.memory.versions = kept.seen(&pass.memory.inputs, &old.memory);
            }
            pass.memory.stale = bound[at].is_none_or(|before| self.passes[before].memory.stale);
            let linked = &plan.passes[plan.schedule[at]];
            if before(at).is_none_or(|(old, _)| !has_same_pipelines(old, linked)) {
                renewed.pipelines.push(pass.name.to_string());
            }
        }
        Ok(Prepared {
            contents: kept.contents(),
            poison: Poison::new(plan, &memory, &self.device)?,
            positions: kept.positions,
            memory,
            passes,
            bound,
            renewed,
        })
    }

    /// Uploads the params of passes whose bytes differ from those before; such a pass counts as changed.
    fn upload(&mut self, before: &Plan, positions: &[Option<usize>]) -> Vec<String> {
        let mut uploads = Vec::new();
        let schedule = self.plan.schedule.iter().zip(positions);
        for ((&pass, position), made) in schedule.zip(&mut self.passes) {
            let pass = &self.plan.passes[pass];
            let Some(position) = *position else {
                continue;
            };
            let old = &before.passes[before.schedule[position]];
            let bytes = |step: &LinkedStep| step.params().map(<[u8]>::to_vec);
            if pass.steps.iter().map(bytes).eq(old.steps.iter().map(bytes)) {
                continue;
            }
            for (buffer, bytes) in made.uploads(pass) {
                self.queue.write_buffer(buffer, 0, bytes);
            }
            made.memory.stale = true;
            uploads.push(pass.name.value.clone());
        }
        uploads
    }
}

/// What an executor becomes with another plan.
struct Prepared {
    memory: Memory,
    contents: Contents,
    poison: Option<Poison>,
    passes: Vec<MadePass>,
    /// Of each pass: its position before.
    positions: Vec<Option<usize>>,
    /// Of each pass: its position before, if it is bound as it was.
    bound: Vec<Option<usize>>,
    renewed: Renewed,
}

/// Whether all steps of a pass have the pipelines that they had.
fn has_same_pipelines(old: &LinkedPass, new: &LinkedPass) -> bool {
    let is_same = |(old, new): (&LinkedStep, &LinkedStep)| {
        old.program().is_none() && new.program().is_none() || same_pipeline(old, new)
    };
    old.steps.len() == new.steps.len() && old.steps.iter().zip(&new.steps).all(is_same)
}

/// What of an executor a new plan keeps.
struct Kept<'a> {
    old: &'a Executor,
    plan: &'a Plan,
    memory: &'a Memory,
    /// Of each pass of the plan: its position before.
    positions: Vec<Option<usize>>,
    /// The resources that are in the memory that they were in before, and what they were then.
    same: BTreeMap<ResourceId, ResourceId>,
}

impl<'a> Kept<'a> {
    fn new(old: &'a Executor, plan: &'a Plan, memory: &'a Memory) -> Self {
        let name = |plan: &'a Plan, pass: usize| plan.passes[pass].name.as_str();
        let schedule = old.plan.schedule.iter().enumerate();
        let positions: HashMap<&str, usize> = schedule
            .map(|(at, pass)| (name(&old.plan, *pass), at))
            .collect();
        let resource = |plan: &'a Plan, id: ResourceId| &plan.resources[id.0];
        let formers: HashMap<&str, ResourceId> = old
            .plan
            .lifetimes
            .keys()
            .map(|id| (resource(&old.plan, *id).name.as_str(), *id))
            .collect();
        let same = plan.lifetimes.keys().filter_map(|&id| {
            let former = *formers.get(resource(plan, id).name.as_str())?;
            let kinds = [resource(plan, id), resource(&old.plan, former)].map(|it| &it.kind);
            let is_same = match kinds {
                [ResourceKind::Sampler(a), ResourceKind::Sampler(b)] => {
                    format!("{a:?}") == format!("{b:?}")
                }
                _ => memory.same(id, &old.memory, former),
            };
            is_same.then_some((id, former))
        });
        let position = |&pass: &usize| positions.get(name(plan, pass)).copied();
        Self {
            old,
            plan,
            memory,
            positions: plan.schedule.iter().map(position).collect(),
            same: same.collect(),
        }
    }

    fn renewed(&self) -> Vec<String> {
        let own =
            |id: &&ResourceId| self.plan.slots.of.contains_key(id) && !self.same.contains_key(id);
        let names = self.plan.lifetimes.keys().filter(own);
        names
            .map(|id| self.plan.resources[id.0].name.clone())
            .collect()
    }

    fn contents(&self) -> Contents {
        let mut contents = Contents::of(self.plan, self.old.contents.clock());
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

    /// The pass at `at`, and what it was before, if everything that it uses is in the memory that it was in before.
    fn with_its_memory(&self, at: usize) -> Option<[&LinkedPass; 2]> {
        let pass = &self.plan.passes[self.plan.schedule[at]];
        let old = &self.old.plan.passes[self.old.plan.schedule[self.positions[at]?]];
        let is_there = pass.accesses.len() == old.accesses.len()
            && pass
                .accesses
                .iter()
                .zip(&old.accesses)
                .all(|(new, old)| self.same.get(&new.resource) == Some(&old.resource));
        is_there.then_some([pass, old])
    }

    /// Of each group: whether its passes still do what they did, whatever their params. Then what they made is still there.
    fn groups(&self) -> Vec<bool> {
        let shader = |step: &LinkedStep| step.program().map(|program| program.shader.clone());
        let is_kept = |[pass, old]: [&LinkedPass; 2]| {
            pass.steps
                .iter()
                .map(shader)
                .eq(old.steps.iter().map(shader))
        };
        let (now, before) = (&self.plan.conditions.group, &self.old.plan.conditions.group);
        let mut kept = vec![true; now.len()];
        // Of each group: which one it was.
        let mut former: Vec<Option<usize>> = vec![None; now.len()];
        let mut is_there = vec![false; before.len()];
        for (at, &group) in now.iter().enumerate() {
            kept[group] &= self.with_its_memory(at).is_some_and(is_kept);
            if let Some(position) = self.positions[at] {
                let was = before[position];
                kept[group] &= *former[group].get_or_insert(was) == was;
                is_there[position] = true;
            }
        }
        // What a pass of the group made that is gone would be left in what the others write; a capture leaves nothing.
        let mut gone = vec![false; before.len()];
        for (position, &pass) in self.old.plan.schedule.iter().enumerate() {
            let leaves = self.old.plan.passes[pass].kind != CAPTURE;
            gone[before[position]] |= !is_there[position] && leaves;
        }
        for (kept, former) in kept.iter_mut().zip(former) {
            *kept &= former.is_none_or(|group| !gone[group]);
        }
        kept
    }

    /// The position before of a pass that needs no binding: word for word what it was, on the same memory.
    fn bound(&self, at: usize) -> Option<usize> {
        let [pass, old] = self.with_its_memory(at)?;
        let mut numbers = pass.accesses.iter().zip(&old.accesses);
        let same_numbers = numbers.all(|(new, old)| new.resource == old.resource);
        self.positions[at].filter(|_| pass.steps == old.steps && same_numbers)
    }

    /// What a pass saw of its inputs when it ran last.
    fn seen(&self, inputs: &[ResourceId], old: &Seen) -> Option<Vec<u64>> {
        let seen = old.inputs.iter().zip(old.versions.as_ref()?);
        let seen: BTreeMap<ResourceId, u64> = seen.map(|(id, seen)| (*id, *seen)).collect();
        let of = |id: &ResourceId| seen.get(self.same.get(id)?).copied();
        let versions: Vec<u64> = inputs.iter().map(of).collect::<Option<_>>()?;
        (versions.len() == seen.len()).then_some(versions)
    }
}
