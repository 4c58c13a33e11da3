//! One pass on the device: pipelines, params, and what is bound in each state of the histories that it touches.

use super::{
    encode::encode_all,
    error::{ExecuteError, named, scoped},
};
use crate::{
    allocate::{Binder, MadeStep, Pipeline, Pipelines, same_pipeline, upload},
    link::LinkedPass,
    memory::{Histories, Memory, Versions},
    plan::Plan,
    resolve::{Origin, ResourceId},
};
use std::sync::Arc;

/// A pass with everything it needs on the device.
pub(super) struct MadePass {
    pub name: Arc<str>,
    /// Of each step.
    pipelines: Vec<Option<Pipeline>>,
    /// Of each step: the uniform `params`.
    params: Vec<Option<wgpu::Buffer>>,
    /// The resources with two versions that it touches.
    histories: Vec<ResourceId>,
    /// Its steps, bound, for each state of those that there was so far.
    variants: Vec<(Vec<Versions>, Vec<MadeStep>)>,
    /// What decides whether it runs again.
    pub memory: Seen,
}

/// What a pass reads, and the versions of it when the pass ran last.
#[derive(Clone, Debug, Default)]
pub(super) struct Seen {
    pub inputs: Vec<ResourceId>,
    /// `None` if it has not run, or what it made is lost.
    pub versions: Option<Vec<u64>>,
    /// Whether its params or state are others than when it ran.
    pub stale: bool,
}

impl MadePass {
    /// Makes the pass at `at` in the schedule; pipelines and params of `old` serve again where they fit. Counts what was made anew
    /// in `renewed`.
    pub fn new(
        plan: &Plan,
        at: usize,
        old: Option<(&LinkedPass, &MadePass)>,
        pipelines: &mut Pipelines,
        device: &wgpu::Device,
    ) -> Result<Self, ExecuteError> {
        let pass = &plan.passes[plan.schedule[at]];
        let refused = |error| named(error, &pass.name, &pass.name.span.to_string());
        let (mut made, mut params) = (Vec::new(), Vec::new());
        for (index, step) in pass.steps.iter().enumerate() {
            let before = old.and_then(|(linked, made)| {
                let serves = same_pipeline(linked.steps.get(index)?, step);
                serves.then_some(made)
            });
            let uniform = before.and_then(|made| made.params[index].clone());
            let made_step = || match before {
                Some(made) => made.pipelines[index].clone(),
                None => pipelines.of(device, &pass.name, step),
            };
            let pipeline = scoped(device, &pass.name, made_step).map_err(refused)?;
            made.push(pipeline);
            params.push(match (uniform, step.params()) {
                (Some(buffer), Some(bytes)) if buffer.size() == bytes.len() as u64 => Some(buffer),
                _ => scoped(device, &pass.name, || upload(device, &pass.name, step))
                    .map_err(refused)??,
            });
        }
        let mut histories: Vec<ResourceId> = pass
            .accesses
            .iter()
            .map(|access| match plan.resources[access.resource.0].origin {
                Origin::Previous(base) => base,
                _ => access.resource,
            })
            .filter(|id| plan.versions(*id) > 1)
            .collect();
        histories.sort();
        histories.dedup();
        Ok(Self {
            name: pass.name.value.as_str().into(),
            pipelines: made,
            params,
            histories,
            variants: Vec::new(),
            memory: Seen {
                inputs: inputs(plan, at),
                versions: None,
                stale: false,
            },
        })
    }

    /// Whether the pass is bound for this state of the histories.
    pub fn is_bound(&self, histories: &Histories) -> bool {
        self.steps(histories).is_some()
    }

    /// The steps for a state of the histories that it was bound for.
    pub fn steps(&self, histories: &Histories) -> Option<&[MadeStep]> {
        let is_state = |(state, _): &&(Vec<Versions>, Vec<MadeStep>)| {
            self.histories
                .iter()
                .zip(state)
                .all(|(id, versions)| histories.get(id) == Some(versions))
        };
        let (_, steps) = self.variants.iter().find(is_state)?;
        Some(steps)
    }

    /// Binds the pass for a state of the histories, and encodes it once into a throw-away encoder, so that whatever the device
    /// refuses is refused here.
    pub fn bind(
        &mut self,
        pass: &LinkedPass,
        memory: &Memory,
        histories: &Histories,
        device: &wgpu::Device,
    ) -> Result<(), ExecuteError> {
        let binder = Binder {
            device,
            memory,
            histories,
        };
        let refused = |error| named(error, &pass.name, &pass.name.span.to_string());
        let steps = scoped(device, &pass.name, || {
            let steps = pass.steps.iter().zip(&self.pipelines).zip(&self.params);
            steps
                .map(|((step, pipeline), params)| {
                    binder.step(&pass.name, step, pipeline.as_ref(), params.as_ref())
                })
                .collect::<Result<Vec<_>, _>>()
        })
        .map_err(refused)??;
        scoped(device, &pass.name, || {
            let mut encoder =
                device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
            encode_all(&steps, &pass.name, &mut encoder, None);
            encoder.finish()
        })
        .map_err(refused)?;
        let state = self
            .histories
            .iter()
            .map(|id| histories.get(id).copied().unwrap_or_default())
            .collect();
        self.variants.push((state, steps));
        Ok(())
    }

    /// Forgets what is bound: something that the pass uses is another than before.
    pub fn unbind(&mut self) {
        self.variants.clear();
    }

    /// Takes over what `old` had bound.
    pub fn rebind_as(&mut self, old: &mut MadePass) {
        self.variants = std::mem::take(&mut old.variants);
    }

    /// The params of each step with their bytes.
    pub fn uploads<'a>(
        &'a self,
        pass: &'a LinkedPass,
    ) -> impl Iterator<Item = (&'a wgpu::Buffer, &'a [u8])> {
        let steps = self.params.iter().zip(&pass.steps);
        steps.filter_map(|(buffer, step)| Some((buffer.as_ref()?, step.params()?)))
    }
}

/// What a pass reads that neither it nor the passes that run together with it write.
pub(super) fn inputs(plan: &Plan, at: usize) -> Vec<ResourceId> {
    let group = Some(plan.conditions.group[at]);
    let accesses = plan.passes[plan.schedule[at]].accesses.iter();
    let mut inputs: Vec<ResourceId> = accesses
        .filter(|access| access.reads || !access.covers)
        .map(|access| access.resource)
        .filter(|id| plan.conditions.writers[id.0] != group)
        .collect();
    inputs.sort();
    inputs.dedup();
    inputs
}
