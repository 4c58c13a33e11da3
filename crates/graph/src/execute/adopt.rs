//! Another plan on the same device: a new size, another value of a param, another graph. What can be kept is kept.

use super::{ExecuteError, Executor, incremental::Contents, pass::MadePass, poison::Poison};
use crate::{
    document::params::ParamValue,
    link::LinkedStep,
    memory::Memory,
    plan::Plan,
    provider::Provider,
    resolve::{ResourceId, ResourceKind},
};

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
        let old = Some((&self.plan, &self.memory));
        let memory = Memory::new(&plan, old, &self.device, &self.queue, provider)?;
        let kept = Kept {
            old: self,
            plan: &plan,
            memory: &memory,
        };
        let mut renewed = Renewed {
            resources: kept.renewed(),
            ..Renewed::default()
        };
        let contents = kept.contents();
        let mut pipelines = std::mem::take(&mut self.pipelines);
        let made = self.passes_of(&plan, &mut pipelines);
        self.pipelines = pipelines;
        let mut passes = made?;
        let poison = Poison::new(&plan, &memory, &self.device)?;
        let kept = Kept {
            old: self,
            plan: &plan,
            memory: &memory,
        };
        let bound: Vec<Option<usize>> = (0..passes.len()).map(|at| kept.bound(at)).collect();
        for (at, pass) in passes.iter_mut().enumerate() {
            pass.memory.versions = kept.versions(at);
            pass.memory.stale = bound[at].is_none_or(|before| self.passes[before].memory.stale);
            let linked = &plan.passes[plan.schedule[at]];
            match kept.before(at) {
                Some(before) => {
                    let linked_before = &self.plan.passes[self.plan.schedule[before]];
                    if linked.steps.len() != linked_before.steps.len()
                        || !linked_before.steps.iter().zip(&linked.steps).all(|(a, b)| {
                            a.program().is_none() && b.program().is_none()
                                || crate::allocate::same_pipeline(a, b)
                        })
                    {
                        renewed.pipelines.push(pass.name.to_string());
                    }
                }
                None => renewed.pipelines.push(pass.name.to_string()),
            }
        }
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
        self.histories = self.contents.histories(&vec![false; self.passes.len()]);
        renewed.uploads = self.upload(&before);
        Ok(renewed)
    }

    fn passes_of(
        &self,
        plan: &Plan,
        pipelines: &mut crate::allocate::Pipelines,
    ) -> Result<Vec<MadePass>, ExecuteError> {
        let make = |at: usize| {
            let name = &plan.passes[plan.schedule[at]].name.value;
            let old = self.plan.position(name);
            let old = old.map(|old| {
                (
                    &self.plan.passes[self.plan.schedule[old]],
                    &self.passes[old],
                )
            });
            MadePass::new(plan, at, old, pipelines, &self.device)
        };
        (0..plan.schedule.len()).map(make).collect()
    }

    /// Uploads the params of passes whose bytes differ from those before; such a pass counts as changed.
    fn upload(&mut self, before: &Plan) -> Vec<String> {
        let mut uploads = Vec::new();
        for (&pass, made) in self.plan.schedule.iter().zip(&mut self.passes) {
            let pass = &self.plan.passes[pass];
            let Some(old) = before.position(&pass.name) else {
                continue;
            };
            let old = &before.passes[before.schedule[old]];
            let bytes = |pass: &crate::link::LinkedPass| -> Vec<Option<Vec<u8>>> {
                let steps = pass.steps.iter();
                steps
                    .map(|step| step.params().map(<[u8]>::to_vec))
                    .collect()
            };
            if bytes(pass) == bytes(old) {
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

/// What of an executor a new plan keeps.
struct Kept<'a> {
    old: &'a Executor,
    plan: &'a Plan,
    memory: &'a Memory,
}

impl Kept<'_> {
    /// The position that the pass at `at` had before.
    fn before(&self, at: usize) -> Option<usize> {
        let name = &self.plan.passes[self.plan.schedule[at]].name.value;
        self.old.plan.position(name)
    }

    /// The resource that was called like this one before.
    fn former(&self, id: ResourceId) -> Option<ResourceId> {
        let name = &self.plan.resources[id.0].name;
        let mut known = self.old.plan.lifetimes.keys();
        known
            .find(|id| self.old.plan.resources[id.0].name == *name)
            .copied()
    }

    /// Whether a resource is in the memory that it was in before.
    fn is_same(&self, id: ResourceId) -> bool {
        let Some(former) = self.former(id) else {
            return false;
        };
        match (
            &self.plan.resources[id.0].kind,
            &self.old.plan.resources[former.0].kind,
        ) {
            (ResourceKind::Sampler(a), ResourceKind::Sampler(b)) => {
                format!("{a:?}") == format!("{b:?}")
            }
            _ => self.memory.same(id, &self.old.memory, former),
        }
    }

    fn renewed(&self) -> Vec<String> {
        let own = |id: &&ResourceId| self.plan.slots.of.contains_key(id) && !self.is_same(**id);
        let names = self.plan.lifetimes.keys().filter(own);
        names
            .map(|id| self.plan.resources[id.0].name.clone())
            .collect()
    }

    fn contents(&self) -> Contents {
        let mut contents = Contents::of(self.plan, self.old.contents.clock());
        for &id in self.plan.lifetimes.keys() {
            if let Some(former) = self.former(id).filter(|_| self.is_same(id)) {
                contents.take_over(id, &self.old.contents, former);
            }
        }
        contents
    }

    /// Whether a pass is word for word what it was, on the same memory.
    fn is_unchanged(&self, at: usize, before: usize) -> bool {
        let pass = &self.plan.passes[self.plan.schedule[at]];
        let old = &self.old.plan.passes[self.old.plan.schedule[before]];
        pass.steps == old.steps && self.has_its_memory(at, before)
    }

    /// Whether everything that a pass uses is in the memory that it was in before.
    fn has_its_memory(&self, at: usize, before: usize) -> bool {
        let pass = &self.plan.passes[self.plan.schedule[at]];
        let old = &self.old.plan.passes[self.old.plan.schedule[before]];
        pass.accesses.len() == old.accesses.len()
            && pass.accesses.iter().zip(&old.accesses).all(|(new, old)| {
                new.resource == old.resource
                    && self.former(new.resource) == Some(old.resource)
                    && self.is_same(new.resource)
            })
    }

    /// Whether a pass still does what it did, whatever its params: then what it made is still there.
    fn is_kept(&self, at: usize) -> bool {
        let Some(before) = self.before(at) else {
            return false;
        };
        let pass = &self.plan.passes[self.plan.schedule[at]];
        let old = &self.old.plan.passes[self.old.plan.schedule[before]];
        let shader = |step: &LinkedStep| step.program().map(|program| program.shader.clone());
        pass.steps.len() == old.steps.len()
            && pass
                .steps
                .iter()
                .zip(&old.steps)
                .all(|(new, old)| shader(new) == shader(old))
            && self.has_its_memory(at, before)
    }

    /// The position before of a pass that needs no binding.
    fn bound(&self, at: usize) -> Option<usize> {
        self.before(at)
            .filter(|&before| self.is_unchanged(at, before))
    }

    /// What a pass saw when it ran last, if what it made then is still there.
    fn versions(&self, at: usize) -> Option<Vec<u64>> {
        let memory = &self.old.passes[self.before(at)?].memory;
        let groups = &self.plan.conditions.group;
        let same_inputs = super::pass::inputs(self.plan, at) == memory.inputs;
        let whole_group = (0..groups.len())
            .filter(|other| groups[*other] == groups[at])
            .all(|other| self.is_kept(other));
        memory
            .versions
            .clone()
            .filter(|_| same_inputs && whole_group)
    }
}
