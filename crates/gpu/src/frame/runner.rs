//! The frames of an executor: what it keeps of them, and how they are encoded and settled, how
//! resources are refreshed, and how another plan takes the place of one.

use super::contents::Contents;
use super::cpu::{CpuTurn, Staging};
use super::fetch::Fetch;
use super::growth::Unchanged;
use super::growth_readback::GrowthReadback;
use super::host_changes::HostChanges;
use super::imports::Imports;
use super::in_flight::{FrameInFlight, FramesInFlight};
use super::pass::GpuPass;
use super::replan::{ReplanReport, Reused, has_same_params};
use super::report::{Frame, FrameReport};
use super::state::{FrameDecision, State};
use super::statistics::Counters;
use super::timer::Timer;
use super::uniform::{FrameUniforms, frame_bytes};
use crate::device::partial;
use crate::error::{ExecuteError, in_encoder, poll, with_table};
use crate::memory::memory::{InFrame, Memory, ResourceFactory, check_bound, check_relied_on};
use crate::memory::physical::PingPong;
use crate::pipelines::pipelines::Pipelines;
use crate::presence::Presence;
use crate::provider::Provider;
use skiagraph_graph::{ParamValue, Plan, ResourceId, caught};
use std::sync::Arc;

/// A plan on a device, and its frames.
pub(super) struct Runner {
    pub device: wgpu::Device,
    pub presence: Presence,
    pub queue: wgpu::Queue,
    pub pipelines: Pipelines,
    pub state: State,
    /// Allocation that each resource with two of them uses in the frame that was encoded last.
    pub ping_pong: PingPong,
    pub decision: FrameDecision,
    pub host_changes: HostChanges,
    /// True if the provider tells each change of a content by a version, or there is none to tell.
    pub knows_changes: bool,
    pub imports: Imports,
    /// Frames that were encoded.
    pub frames: u32,
    pub frames_in_flight: FramesInFlight,
    /// Means by which items come back for work of the CPU.
    pub staging: Staging,
    /// The passes that the frame that was encoded last did not run.
    pub skipped: Vec<Arc<str>>,
}

impl Runner {
    /// Makes all that a plan needs, as [`Executor::new`](super::Executor::new) does.
    pub fn new(
        pipelines: &Pipelines,
        queue: &wgpu::Queue,
        plan: Plan,
        provider: &mut dyn Provider,
    ) -> Result<Self, ExecuteError> {
        let device = pipelines.device();
        let mut presence = Presence::new(device).map_err(|error| with_table(error, &plan))?;
        presence.check_queue(queue)?;
        presence.check_provider(provider)?;
        check_backend(device, &plan)?;
        let mut factory = ResourceFactory::new((device, queue), provider);
        let state = State::new(plan, pipelines, &mut factory)?;
        let frames_in_flight =
            FramesInFlight::new(device).map_err(|error| with_table(error, &state.plan))?;
        let mut runner = Self {
            device: device.clone(),
            presence,
            queue: queue.clone(),
            pipelines: pipelines.clone(),
            ping_pong: state.ping_pong(true),
            state,
            decision: FrameDecision::default(),
            host_changes: HostChanges::default(),
            knows_changes: false,
            imports: Imports::default(),
            frames: 0,
            frames_in_flight,
            staging: Staging::default(),
            skipped: Vec::new(),
        };
        runner.state.bind_what_can_be(device)?;
        runner.note_changes(provider);
        Ok(runner)
    }

    pub fn plan(&self) -> &Plan {
        &self.state.plan
    }

    /// Returns the memory of the frame that was encoded last.
    pub fn in_frame(&self) -> InFrame<'_> {
        InFrame::new(&self.state.plan, &self.state.memory, &self.ping_pong)
    }

    pub fn encode_with(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        frame: &Frame<'_>,
        gives_up: Option<&dyn Fn() -> bool>,
    ) -> Result<u32, ExecuteError> {
        self.presence.check()?;
        if self.frames_in_flight.is_pending() {
            self.settle()?;
        }
        self.grow_by_itself()?;
        let is_measured = frame.timing || frame.statistics;
        let knows_all = self.knows_changes && self.imports.are_told(&self.state);
        let may_rest = !frame.all && !is_measured && knows_all;
        let number = (self.frames, frame.all);
        self.state.decide(number, may_rest, &mut self.decision);
        let decision = &self.decision;
        self.state
            .bind(&decision.runs, &decision.ping_pong, &self.device)?;
        let mut frame_in_flight = self.frames_in_flight.begin();
        if let Err(error) = self.prepare(&mut frame_in_flight, frame) {
            self.frames_in_flight.recycle(frame_in_flight);
            return Err(with_table(error, self.plan()));
        }
        // From here on nothing can fail but work of the CPU, if the encoder is of the device. wgpu
        // does not tell that, and panics where an instance has no thing of a number.
        let recorded = caught(|| self.record(&mut frame_in_flight, encoder, gives_up));
        let recorded = recorded.unwrap_or_else(|panicked| Err(in_encoder(panicked)));
        if let Err(error) = recorded {
            // Its queries are not resolved, and what it has written stays. The source of its
            // uniforms may be unmapped already.
            frame_in_flight.timer = None;
            frame_in_flight.uniforms = None;
            let before = &frame_in_flight.before;
            self.state.forget_frame(&self.decision, before);
            self.frames_in_flight.recycle(frame_in_flight);
            return Err(error);
        }
        let index = frame_in_flight.index;
        frame_in_flight.changed = std::mem::take(&mut self.host_changes.changed);
        self.skipped.clone_from(&frame_in_flight.skipped);
        self.frames_in_flight.submit(frame_in_flight, encoder);
        std::mem::swap(&mut self.ping_pong, &mut self.decision.ping_pong);
        self.frames = self.frames.wrapping_add(1);
        Ok(index)
    }

    /// Gets ready the uniform, readbacks and timers that a frame needs besides its passes.
    fn prepare(
        &mut self,
        frame_in_flight: &mut FrameInFlight,
        frame: &Frame<'_>,
    ) -> Result<(), ExecuteError> {
        frame_in_flight.index = self.frames;
        if let Some(id) = self.state.uniform {
            let content = frame_bytes((self.frames, frame.seconds, self.host_changes.changed));
            self.state.memory.set_uniform(id, &content);
        }
        let (state, device) = (&self.state, &self.device);
        if !self.decision.rests {
            FrameUniforms::write(&mut frame_in_flight.uniforms, &state.memory, device)?;
        }
        for name in frame.read {
            let ping_pong = &self.decision.ping_pong;
            let source = InFrame::new(&state.plan, &state.memory, ping_pong);
            let staging = &mut self.frames_in_flight.staging;
            let fetch = Fetch::new(name, &state.readables, source, staging, device)?;
            frame_in_flight.fetches.push(fetch);
        }
        if frame.timing && frame_in_flight.timer.is_none() {
            frame_in_flight.timer = Some(Timer::new(device, &self.queue)?);
        }
        frame_in_flight.is_timed = frame.timing;
        if frame.statistics {
            frame_in_flight.counters = Counters::new(&state.plan, device)?;
        }
        let rests = self.decision.rests;
        self.frames_in_flight.number(frame_in_flight, rests, device)
    }

    /// Encodes a frame that everything is ready for.
    fn record(
        &mut self,
        frame_in_flight: &mut FrameInFlight,
        encoder: &mut wgpu::CommandEncoder,
        gives_up: Option<&dyn Fn() -> bool>,
    ) -> Result<(), ExecuteError> {
        let state = &mut self.state;
        let decision = &self.decision;
        let ping_pong = &decision.ping_pong;
        let number = frame_in_flight.number;
        frame_in_flight.before.clone_from(&state.contents);
        if let Some(uniforms) = frame_in_flight
            .uniforms
            .as_mut()
            .filter(|_| !decision.rests)
        {
            uniforms.copy(&state.memory, encoder);
        }
        state.copy_grown(encoder);
        let memory = &state.memory;
        let mut copy_host = |copy| State::copy_host(memory, copy, encoder);
        state.contents.first_copies(number, &mut copy_host);
        let mut cpu = gives_up.map(|gives_up| CpuTurn {
            device: &self.device,
            queue: &self.queue,
            staging: &mut self.staging,
            gives_up,
            worked: None,
            frame: frame_in_flight.index,
            has_submitted: false,
        });
        let encoded = state.encode(decision, frame_in_flight, encoder, cpu.as_mut());
        if encoded.is_ok() || cpu.is_some_and(|cpu| cpu.has_submitted) {
            frame_in_flight.grown.append(&mut state.grown);
        }
        encoded?;
        let is_timed = frame_in_flight.is_timed;
        if let Some(timer) = frame_in_flight.timer.as_mut().filter(|_| is_timed) {
            timer.resolve(encoder);
        }
        if let Some(counters) = &frame_in_flight.counters {
            counters.resolve(encoder);
        }
        for fetch in &frame_in_flight.fetches {
            fetch.copy(encoder);
        }
        if !decision.rests {
            let (mut is_counted, change) = (true, state.idle.changes);
            let frame = InFrame::new(&state.plan, memory, ping_pong);
            for readback in &mut state.growth_readbacks {
                is_counted &= readback.copy(change, frame, encoder);
            }
            // Else a resource that has no room could stay so.
            frame_in_flight.changes = is_counted.then_some(change);
        }
        let (plan, passes) = (&state.plan, &state.passes);
        let before = (number, &frame_in_flight.before, ping_pong);
        if !decision.rests {
            state.contents.ran(plan, passes, &decision.runs, before);
        }
        let memory = &state.memory;
        let mut copy_host = |copy| State::copy_host(memory, copy, encoder);
        let pending = self.frames_in_flight.oldest_pending();
        state.contents.copies(number, pending, &mut copy_host);
        Ok(())
    }

    pub fn poll(&mut self) -> Result<Option<FrameReport>, ExecuteError> {
        self.presence.check()?;
        if self.frames_in_flight.asked() == 0 {
            return Ok(None);
        }
        self.settle()?;
        self.report()
    }

    /// Returns the report of the oldest frame with requests, if the GPU has finished it.
    pub fn report(&mut self) -> Result<Option<FrameReport>, ExecuteError> {
        self.frames_in_flight.report(&self.device, &self.presence)
    }

    /// Finds out which frames have run, and takes back what was noted for those that are lost.
    pub fn settle(&mut self) -> Result<(), ExecuteError> {
        poll(&self.device, wgpu::PollType::Poll)?;
        #[cfg(target_arch = "wasm32")]
        if let Some((name, error)) = crate::late::take() {
            return Err(crate::error::refusal(&name, &error));
        }
        let (frames, state) = (&mut self.frames_in_flight, &mut self.state);
        let setback = frames.settle();
        state.idle.settled = setback.settled.or(state.idle.settled);
        if setback.is_lost || setback.forgets {
            state.idle.note_change();
            let from_last = frames.under_way.iter_mut().rev();
            for lost in from_last.filter(|frame| frame.is_lost()) {
                self.host_changes.tell_again(lost.changed);
                state.grown.splice(..0, lost.grown.drain(..));
                if Some(lost.number) == setback.rewind {
                    state.contents.rewind(&state.plan, &lost.before);
                }
            }
            if setback.forgets {
                let under_way = frames.under_way.iter_mut();
                let followed = under_way.filter(|frame| frame.is_followed);
                let followed =
                    followed.map(|frame| (frame.number, frame.is_lost(), &mut frame.before));
                state.contents.forget(&mut followed.collect::<Vec<_>>());
                self.host_changes.note_new_memory();
            }
            self.ping_pong = state.ping_pong(false);
        }
        self.frames_in_flight.sweep();
        Ok(())
    }

    pub fn refresh(&mut self, provider: &mut dyn Provider) -> Result<(), ExecuteError> {
        self.presence.check()?;
        self.presence.check_provider(provider)?;
        // If it fails half way, some resources are this provider's.
        self.knows_changes &= provider.has_versions();
        let mut built = Vec::new();
        let refreshed = self.refresh_live(provider, &mut built);
        let refreshed = refreshed.and(self.submit_built(provider, &built));
        if refreshed.is_ok() {
            self.note_changes(provider);
        } else {
            self.host_changes.touch_all();
        }
        refreshed.map_err(|error| with_table(error, self.plan()))
    }

    /// Notes which provided resources have changed; called after live passes have the new ones.
    pub fn note_changes(&mut self, provider: &dyn Provider) {
        let knows = provider.has_versions() || self.state.memory.provided().is_empty();
        if knows && !self.knows_changes {
            // There may have been others before.
            self.state.idle.note_change();
        }
        self.knows_changes = knows;
        match self.state.uniform {
            Some(_) => self.host_changes.compare(provider),
            None => self.host_changes.forget(),
        }
    }

    /// Has the provider submit what it has recorded; without it those resources are not there.
    fn submit_built(
        &mut self,
        provider: &mut dyn Provider,
        built: &[ResourceId],
    ) -> Result<(), ExecuteError> {
        if built.is_empty() {
            return Ok(());
        }
        let mut factory = ResourceFactory::new((&self.device, &self.queue), provider);
        let submitted = factory.submit_built();
        if let Err(why) = &submitted {
            for &id in built {
                self.state.memory.forget(id, why.to_string());
                self.state.unbind(id);
            }
        }
        submitted
    }

    /// Refreshes the resources of live passes and lists them in `built`, that which fails, too.
    fn refresh_live(
        &mut self,
        provider: &mut dyn Provider,
        built: &mut Vec<ResourceId>,
    ) -> Result<(), ExecuteError> {
        check_relied_on(&self.state.plan, provider)?;
        let has_versions = provider.has_versions();
        for (id, version) in self.state.memory.provided().clone() {
            let state = &mut self.state;
            let resource = state.plan.resource(id);
            // Another description is another version.
            let is_described = has_versions || check_bound(resource, provider)?;
            if is_described && Ok(provider.version(&resource.name)) == version {
                continue;
            }
            let before = state.memory.host(id).cloned();
            let mut factory = ResourceFactory::new((&self.device, &self.queue), provider);
            let refreshed = state.memory.refresh(id, &state.plan, None, &mut factory);
            // The provider has recorded nothing for a uniform that it has told.
            if !state.memory.uniforms().contains_key(&id) {
                built.push(id);
            }
            refreshed?;
            state.touch(id);
            let now = state.memory.host(id);
            if now.is_some() {
                self.host_changes
                    .changed
                    .note(&state.plan.resource(id).name);
            }
            if now == before.as_ref() {
                continue;
            }
            if Memory::is_alike(now, before.as_ref()) {
                state.rebind(id)
            } else {
                state.unbind(id)
            }
        }
        Ok(())
    }

    /// Changes the value of a param that shaders read only in their uniform.
    pub fn set_in_uniforms(
        &mut self,
        name: &str,
        value: ParamValue,
        provider: &mut dyn Provider,
    ) -> Result<ReplanReport, ExecuteError> {
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
            state.set_params(at, params);
            report.uploads.push(state.passes[at].name.to_string());
        }
        Ok(report)
    }

    /// Replaces the plan as [`Executor::replace_graph`](super::Executor::replace_graph) does, but
    /// leaves the flags of the uniform `frame` alone.
    pub fn put_in(
        &mut self,
        plan: Plan,
        provider: &mut dyn Provider,
    ) -> Result<ReplanReport, ExecuteError> {
        self.presence.check()?;
        self.presence.check_provider(provider)?;
        check_backend(&self.device, &plan)?;
        let mut factory = ResourceFactory::new((&self.device, &self.queue), provider);
        let before = (&self.state.plan, &self.state.memory);
        let memory = Memory::new(&plan, Some(before), &mut factory);
        let memory = memory.map_err(|error| with_table(error, &plan))?;
        let reused = Reused::new(&self.state, &plan, &memory);
        let made = reused.passes(&self.pipelines);
        let passes = made.map_err(|error| with_table(error, &plan))?;
        let mut report = ReplanReport {
            pipelines: reused.made_pipelines(),
            resources: reused.made_resources(),
            ..ReplanReport::default()
        };
        let contents = reused.contents(&passes, &self.state.contents);
        let frames = self.frames_in_flight.under_way.iter();
        let befores = frames.map(|frame| match frame.is_followed {
            true => reused.contents(&passes, &frame.before),
            false => Contents::default(),
        });
        let befores: Vec<Contents> = befores.collect();
        let has_new_memory = reused.has_new_memory();
        let bound: Vec<Option<usize>> = (0..passes.len()).map(|at| reused.bound(at)).collect();
        let positions = reused.positions;
        let mut state = State::of(plan, memory, passes, contents, &self.device)?;
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
        for (frame, before) in self.frames_in_flight.under_way.iter_mut().zip(befores) {
            frame.before = before;
            frame.changes = None;
        }
        // Content due for a buffer that has grown again is copied on from there.
        self.state.grown.splice(..0, before.grown);
        if has_new_memory {
            self.host_changes.note_new_memory();
        }
        self.ping_pong = self.state.ping_pong(false);
        self.frames_in_flight.staging.clear();
        self.staging = Staging::default();
        report.uploads = self.note_params(&before.plan, &positions);
        Ok(report)
    }

    /// Marks the passes whose params differ from the former plan's as changed, and returns their
    /// names.
    fn note_params(&mut self, before: &Plan, positions: &[Option<usize>]) -> Vec<String> {
        let mut uploads = Vec::new();
        for (at, (pass, position)) in self.state.plan.live().zip(positions).enumerate() {
            let Some(position) = *position else {
                continue;
            };
            let old = before.pass(before.schedule().passes[position]);
            if !has_same_params(old, pass) {
                self.state.contents.stale[at] = true;
                uploads.push(pass.name.value.clone());
            }
        }
        uploads
    }

    /// Grows as [`Executor::grow`](super::Executor::grow) does, with the provided resources that
    /// the executor has.
    fn grow_by_itself(&mut self) -> Result<(), ExecuteError> {
        let Some(plan) = self.larger() else {
            return Ok(());
        };
        let before = self.plan();
        let held = self.state.memory.provided().iter();
        let named = held.map(|(id, version)| (before.resource(*id).name.clone(), version.clone()));
        let mut unchanged = Unchanged {
            plan: before.clone(),
            versions: named.collect(),
        };
        self.grow_to(plan, &mut unchanged).map(drop)
    }

    /// Returns the plan with room for all items and layers that finished frames have asked for;
    /// `None` if everything had room.
    pub fn larger(&mut self) -> Option<Result<Plan, ExecuteError>> {
        let growth_readbacks = self.state.growth_readbacks.iter_mut();
        let wanted = growth_readbacks.filter_map(|readback| {
            let wanted = readback.wanted()?;
            Some((readback.name.clone(), wanted))
        });
        let wanted: Vec<(String, u64)> = wanted.collect();
        if wanted.is_empty() {
            return None;
        }
        let mut grown = self.plan().grown().clone();
        grown.extend(wanted);
        let larger = self.plan().with(|request| request.grown = grown);
        // An error is the host's limit for memory.
        Some(larger.map_err(ExecuteError::from))
    }

    pub fn grow_to(
        &mut self,
        plan: Result<Plan, ExecuteError>,
        provider: &mut dyn Provider,
    ) -> Result<Option<ReplanReport>, ExecuteError> {
        match plan.and_then(|plan| self.put_in(plan, provider)) {
            Err(
                ExecuteError::Plan(_)
                | ExecuteError::OutOfMemory { .. }
                | ExecuteError::Resource { .. }
                | ExecuteError::Gpu { .. },
            ) => {
                self.state.growth_readbacks.clear();
                Ok(None)
            }
            // It is to be counted again.
            Err(error) => {
                self.state.idle.note_change();
                Err(error)
            }
            Ok(report) => Ok(Some(report)),
        }
    }
}

/// Refuses a plan whose graph is not proven on the device's backend.
fn check_backend(device: &wgpu::Device, plan: &Plan) -> Result<(), ExecuteError> {
    if let Some(backend) = partial(device.adapter_info().backend) {
        plan.check_backend(&backend)?;
    }
    Ok(())
}
