//! A pass on the device: its pipelines, params, and bindings for each state of the ping-pong.

use super::encode::{Meters, encode_all};
use crate::error::{ExecuteError, named, scoped};
use crate::memory::memory::InFrame;
use crate::memory::physical::{PingPong, Versions};
use crate::pipelines::bind::{Binder, upload};
use crate::pipelines::handles::Handles;
use crate::pipelines::key::same_pipeline;
use crate::pipelines::pipelines::{Pipeline, Pipelines};
use skiagraph_graph::{LinkedPass, Origin, Plan, ResourceId, step::Step};
use std::sync::Arc;

/// A pass with its pipelines, params and bindings.
pub(super) struct GpuPass {
    pub name: Arc<str>,
    /// Pipeline of each step; `None` for one without a shader.
    pipelines: Vec<Option<Arc<Pipeline>>>,
    /// Buffer of the uniform `params` of each step; `None` for steps without one.
    params: Vec<Option<wgpu::Buffer>>,
    /// The resources with two allocations that the pass uses.
    ping_pong: Vec<ResourceId>,
    /// The bound steps for each state of these resources that has occurred so far.
    variants: Vec<(Vec<Versions>, Vec<Step<Handles>>)>,
    /// The states for which the device has accepted the pass.
    tried: Vec<Vec<Versions>>,
    /// The resources whose changes decide if the pass runs again.
    pub inputs: Vec<ResourceId>,
}

impl GpuPass {
    /// Creates the pass at position `at` of the schedule. Pipelines and params of the former pass
    /// `old` are reused where they match.
    pub fn new(
        plan: &Plan,
        at: usize,
        old: Option<(&LinkedPass, &GpuPass)>,
        pipelines: &Pipelines,
    ) -> Result<Self, ExecuteError> {
        let pass = plan.pass(plan.schedule().passes[at]);
        let (mut made, mut params) = (Vec::new(), Vec::new());
        for (index, step) in pass.steps.iter().enumerate() {
            let before = old.and_then(|(linked, made)| {
                let serves = same_pipeline(linked.steps.get(index)?, step);
                serves.then_some(made)
            });
            // Frames that are not submitted yet read those of before.
            let own = pass.params().nth(index);
            let same = old.filter(|(linked, _)| linked.params().nth(index) == own);
            let uniform = before.filter(|_| same.is_some());
            let uniform = uniform.and_then(|made| made.params[index].clone());
            made.push(match before {
                Some(made) => made.pipelines[index].clone(),
                None => pipelines.get_or_make(pass, step)?,
            });
            params.push(match uniform {
                Some(buffer) => Some(buffer),
                None => upload(pipelines.device(), pass, step)?,
            });
        }
        Ok(Self {
            name: pass.name.value.as_str().into(),
            pipelines: made,
            params,
            ping_pong: two_versions(plan, pass),
            variants: Vec::new(),
            tried: Vec::new(),
            inputs: inputs(plan, at),
        })
    }

    /// True if the pass is bound for this state of the ping-pong.
    pub fn is_bound(&self, ping_pong: &PingPong) -> bool {
        self.steps(ping_pong).is_some()
    }

    /// Returns the bound steps for a state of the ping-pong; `None` if the pass is not bound for
    /// it.
    pub fn steps(&self, ping_pong: &PingPong) -> Option<&[Step<Handles>]> {
        let is_state = |(state, _): &&(Vec<Versions>, _)| {
            let mut resources = self.ping_pong.iter().zip(state);
            resources.all(|(id, versions)| ping_pong.get(id) == Some(versions))
        };
        let (_, steps) = self.variants.iter().find(is_state)?;
        Some(steps)
    }

    /// Binds the pass for a state of the ping-pong. The first time it also encodes the pass into a
    /// throw-away encoder, so that errors of the device are found here.
    pub fn bind(
        &mut self,
        at: usize,
        frame: InFrame<'_>,
        device: &wgpu::Device,
    ) -> Result<(), ExecuteError> {
        let plan = frame.plan;
        let pass = plan.pass(plan.schedule().passes[at]);
        let binder = Binder {
            device,
            frame,
            discarded: &plan.discarded(at),
        };
        let refused = |error| named(error, pass);
        let steps = scoped(device, &pass.name, || {
            let steps = pass.steps.iter().zip(&self.pipelines).zip(&self.params);
            let bound = steps.map(|((step, pipeline), params)| {
                binder.step(&pass.name, step, pipeline.as_deref(), params.as_ref())
            });
            bound.collect::<Result<Vec<_>, _>>()
        });
        let steps = steps.map_err(refused)??;
        let versions = |id: &ResourceId| frame.ping_pong.get(id).copied().unwrap_or_default();
        let state: Vec<Versions> = self.ping_pong.iter().map(versions).collect();
        if !self.tried.contains(&state) {
            scoped(device, &pass.name, || {
                let mut encoder = device.create_command_encoder(&Default::default());
                let done = encode_all(&steps, &pass.name, &mut encoder, Meters::default(), None);
                encoder.finish();
                done
            })
            .map_err(refused)??;
            self.tried.push(state.clone());
        }
        self.variants.push((state, steps));
        Ok(())
    }

    /// Drops all bindings, after a resource of the pass was replaced.
    pub fn unbind(&mut self) {
        self.rebind();
        self.tried.clear();
    }

    /// Drops all bindings, after a buffer of the pass was replaced by one of the same size and
    /// usage. The device need not accept the pass again.
    pub fn rebind(&mut self) {
        self.variants.clear();
    }

    /// Takes over the bindings of `old`.
    pub fn rebind_as(&mut self, old: &mut GpuPass) {
        self.variants = std::mem::take(&mut old.variants);
        self.tried = std::mem::take(&mut old.tried);
    }

    /// Creates the buffers of the uniform `params` of each step, with the values of a linked pass.
    pub fn params_of(
        pass: &LinkedPass,
        device: &wgpu::Device,
    ) -> Result<Vec<Option<wgpu::Buffer>>, ExecuteError> {
        let params = pass.steps.iter().map(|step| upload(device, pass, step));
        params.collect()
    }

    /// Sets other params, in new buffers: frames that are not submitted yet still read the former
    /// ones.
    pub fn set_params(&mut self, params: Vec<Option<wgpu::Buffer>>) {
        self.params = params;
        self.rebind();
    }
}

/// Returns the resources with two allocations of which the pass uses one or both.
fn two_versions(plan: &Plan, pass: &LinkedPass) -> Vec<ResourceId> {
    let base = |id: ResourceId| match plan.resource(id).origin {
        Origin::Previous(base) => base,
        _ => id,
    };
    let touched = pass.accesses.iter().map(|access| base(access.resource));
    let mut touched: Vec<ResourceId> = touched.filter(|id| plan.versions(*id) > 1).collect();
    touched.sort();
    touched.dedup();
    touched
}

/// Returns the resources that a pass reads and that no pass of its group writes.
fn inputs(plan: &Plan, at: usize) -> Vec<ResourceId> {
    let conditions = &plan.schedule().conditions;
    let group = conditions.group[at];
    let accesses = plan.pass(plan.schedule().passes[at]).accesses.iter();
    let mut inputs: Vec<ResourceId> = accesses
        .filter(|access| access.triggers && (access.reads || !access.fully_overwrites))
        .map(|access| access.resource)
        .filter(|id| !conditions.is_written_by(group, *id))
        .collect();
    inputs.sort();
    inputs.dedup();
    inputs
}
