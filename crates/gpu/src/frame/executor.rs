//! A plan on a device, and its frames.

use super::{
    fetch::Fetch,
    growth::Unchanged,
    growth_readback::GrowthReadback,
    host_changes::HostChanges,
    in_flight::{FrameInFlight, FramesInFlight, names},
    pass::GpuPass,
    prepare::{Prepared, Preparer},
    replan::{ReplanReport, Reused, has_same_params},
    report::{Frame, FrameReport},
    state::{FrameDecision, State},
    statistics::Counters,
    timer::Timer,
    uniform::FrameUniform,
};
use crate::{
    device::partial,
    error::{ExecuteError, poll, wait, with_table},
    memory::{
        import::differs,
        memory::{Memory, ResourceFactory},
        physical::{Physical, PingPong},
    },
    pipelines::pipelines::Pipelines,
    presence::Presence,
    provider::Provider,
};
use skiagraph_graph::{LinkedPass, Origin, ParamValue, Plan, Resource, ResourceKind};
use std::{
    sync::Arc,
    time::{Duration, Instant},
};

/// How long it is waited for another thread that polls the device to say what is done.
const CALLBACK: Duration = Duration::from_secs(10);

/// A plan on a device.
///
/// For each frame call [`encode`](Self::encode), then submit the encoder. Only if times or
/// readbacks were asked for, call [`poll`](Self::poll), which does not wait, in this frame or a
/// later one, or [`finish`](Self::finish), which waits. Submit every such encoder, in the order of
/// encoding: later frames use what earlier ones wrote, in passes that are skipped and as
/// `.previous`.
pub struct Executor {
    device: wgpu::Device,
    presence: Presence,
    queue: wgpu::Queue,
    pipelines: Pipelines,
    state: State,
    /// Whose turn it was in the frame that was encoded last.
    ping_pong: PingPong,
    decision: FrameDecision,
    host_changes: HostChanges,
    /// Frames that were encoded.
    frames: u32,
    frames_in_flight: FramesInFlight,
    /// The passes that the frame that was encoded last did not run.
    skipped: Vec<Arc<str>>,
}

impl Executor {
    /// Makes what the plan needs on the device, asks the provider for what live passes bind, and
    /// encodes every pass once into a throw-away encoder, so that whatever the device refuses is
    /// refused here. (A pass that uses an import is tried when it is first needed after the import
    /// was handed over: in [`Executor::encode`], before the host's encoder is touched.)
    ///
    /// # Errors
    /// See [`ExecuteError`]; an error about a pass names it and its place.
    pub fn new(
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        plan: Plan,
        provider: &mut dyn Provider,
    ) -> Result<Self, ExecuteError> {
        let presence = Presence::new(device)?;
        check_backend(device, &plan)?;
        let mut pipelines = Pipelines::default();
        let mut factory = ResourceFactory {
            device,
            queue,
            provider,
        };
        let state = State::new(plan, &mut pipelines, &mut factory)?;
        let mut executor = Self {
            device: device.clone(),
            presence,
            queue: queue.clone(),
            pipelines,
            ping_pong: state.ping_pong(true),
            state,
            decision: FrameDecision::default(),
            host_changes: HostChanges::default(),
            frames: 0,
            frames_in_flight: FramesInFlight::default(),
            skipped: Vec::new(),
        };
        executor.state.bind_what_can_be(device)?;
        executor.note_changes(provider);
        Ok(executor)
    }

    /// The plan.
    pub fn plan(&self) -> &Plan {
        &self.state.plan
    }

    /// Encodes a frame, which the host submits; returns its number. It never waits: any number of
    /// frames may be under way. A resource with `grow` that was too small for an earlier frame, as
    /// submissions have told since, is larger from this frame on: see [`Plan::grown`].
    ///
    /// # Errors
    /// If an output is asked for that the plan does not have, an import or something of the
    /// provider's is missing, the device is lost or has no memory to read something back, or
    /// refuses a pass that is bound in this frame for the first time. Nothing has been encoded
    /// then.
    pub fn encode(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        frame: &Frame<'_>,
    ) -> Result<u32, ExecuteError> {
        self.presence.check()?;
        self.grow_by_itself()?;
        self.state.decide(frame.all, &mut self.decision);
        let FrameDecision { runs, ping_pong } = &self.decision;
        self.state.bind(runs, ping_pong, &self.device)?;
        let mut frame_in_flight = self.frames_in_flight.begin();
        if let Err(error) = self.prepare(&mut frame_in_flight, frame) {
            self.frames_in_flight.recycle(frame_in_flight);
            return Err(with_table(error, self.plan()));
        }
        // From here on nothing can fail.
        self.record(&mut frame_in_flight, encoder);
        let index = frame_in_flight.index;
        self.host_changes.clear();
        self.skipped.clone_from(&frame_in_flight.skipped);
        self.frames_in_flight.submit(frame_in_flight, encoder);
        std::mem::swap(&mut self.ping_pong, &mut self.decision.ping_pong);
        self.frames = self.frames.wrapping_add(1);
        Ok(index)
    }

    /// Gets ready what a frame needs besides the passes' own.
    fn prepare(
        &mut self,
        frame_in_flight: &mut FrameInFlight,
        frame: &Frame<'_>,
    ) -> Result<(), ExecuteError> {
        let (state, device) = (&self.state, &self.device);
        frame_in_flight.index = self.frames;
        if state.uniform.is_some() {
            let values = (self.frames, frame.seconds, self.host_changes.changed());
            FrameUniform::write(&mut frame_in_flight.uniform, values, device)?;
        }
        for name in frame.read {
            let source = (&state.plan, &state.memory, &self.decision.ping_pong);
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
        Ok(())
    }

    /// Encodes a frame that everything is ready for.
    fn record(&mut self, frame_in_flight: &mut FrameInFlight, encoder: &mut wgpu::CommandEncoder) {
        let state = &mut self.state;
        let FrameDecision { runs, ping_pong } = &self.decision;
        if let (Some(id), Some(copy)) = (state.uniform, &mut frame_in_flight.uniform)
            && let Ok(uniform) = state.memory.buffer(id, ping_pong)
        {
            copy.copy(uniform, encoder);
        }
        state.copy_grown(encoder);
        let memory = &state.memory;
        let mut copy_host = |copy| State::copy_host(memory, copy, encoder);
        state.contents.first_copies(&mut copy_host);
        state.encode(&self.decision, frame_in_flight, encoder);
        if let Some(timer) = frame_in_flight
            .timer
            .as_mut()
            .filter(|_| frame_in_flight.is_timed)
        {
            timer.resolve(encoder);
        }
        if let Some(counters) = &frame_in_flight.counters {
            counters.resolve(encoder);
        }
        frame_in_flight
            .fetches
            .iter()
            .for_each(|fetch| fetch.copy(encoder));
        for readback in &mut state.growth_readbacks {
            readback.copy(&state.plan, &state.memory, ping_pong, encoder);
        }
        let (plan, passes) = (&state.plan, &mut state.passes);
        state.contents.ran(plan, passes, runs, ping_pong);
        let memory = &state.memory;
        let mut copy_host = |copy| State::copy_host(memory, copy, encoder);
        state.contents.copies(&mut copy_host);
    }

    /// Returns the report of a frame that asked for times or contents, if it is done: the oldest
    /// one that was not handed out yet. It never waits. Each such frame brings one report, in the
    /// order of encoding, but for those whose encoders were dropped and not submitted.
    ///
    /// # Errors
    /// If the device was lost, or something could not be read back or timed: that frame brings no
    /// report.
    pub fn poll(&mut self) -> Result<Option<FrameReport>, ExecuteError> {
        if self.under_way() == 0 {
            return Ok(None);
        }
        poll(&self.device, wgpu::PollType::Poll)?;
        self.frames_in_flight.report(&self.device, &self.presence)
    }

    /// How many frames have asked for times or contents that were not handed out yet. A host that
    /// asks in every frame must ask [`poll`](Self::poll), too, or they become ever more.
    pub fn under_way(&self) -> usize {
        self.frames_in_flight.asked()
    }

    /// Waits until all that was submitted is done, and hands out what [`poll`](Self::poll) would.
    /// If no frame brings a report, it names the passes that were skipped in the one that was
    /// encoded last.
    ///
    /// # Errors
    /// Those of [`poll`](Self::poll), and [`ExecuteError::NotSubmitted`].
    pub fn finish(&mut self) -> Result<FrameReport, ExecuteError> {
        self.finish_within(None)
    }

    /// [`finish`](Self::finish) that waits no longer than `timeout`, if there is one. A shader that
    /// never ends blocks some drivers for ever; others lose the device.
    ///
    /// # Errors
    /// Besides those of `finish`: [`ExecuteError::Unfinished`]. The frame can be waited for again.
    /// A host that gives up must know that wgpu waits, without end, when the last handle of the
    /// queue is dropped: `std::mem::forget` a clone of it to let the process end.
    pub fn finish_within(
        &mut self,
        timeout: Option<Duration>,
    ) -> Result<FrameReport, ExecuteError> {
        let began = Instant::now();
        // One that is done is not kept waiting by those behind it.
        if let Some(report) = self.poll()? {
            return Ok(report);
        }
        if !wait(&self.device, timeout)? {
            return Err(self.unfinished(began));
        }
        // A device that was destroyed is waited for without complaint, but has no query buffers to
        // take times from.
        self.presence.check()?;
        let waited = Instant::now();
        loop {
            if let Some(report) = self.frames_in_flight.report(&self.device, &self.presence)? {
                return Ok(report);
            }
            if self.under_way() == 0 {
                return Ok(FrameReport {
                    index: self.frames.wrapping_sub(1),
                    skipped: names(&self.skipped),
                    ..FrameReport::default()
                });
            }
            if timeout.is_some_and(|timeout| began.elapsed() >= timeout) {
                return Err(self.unfinished(began));
            }
            if waited.elapsed() >= CALLBACK {
                break;
            }
            // Another thread that polls the device may be about to say so.
            std::thread::sleep(Duration::from_micros(50));
        }
        // The profiler never gives up a frame whose timestamps cannot be mapped.
        self.frames_in_flight.give_up_times();
        let report = self.frames_in_flight.report(&self.device, &self.presence)?;
        report.ok_or(ExecuteError::NotSubmitted)
    }

    /// Names the passes of the last frame.
    fn unfinished(&self, began: Instant) -> ExecuteError {
        let passes = self.state.passes.iter().map(|pass| &*pass.name);
        let ran = passes.filter(|name| self.skipped.iter().all(|skipped| **skipped != **name));
        ExecuteError::Unfinished {
            after: began.elapsed(),
            passes: list(&ran.collect::<Vec<_>>()),
        }
    }

    /// Hands over a texture that the plan was told of in
    /// [`PlanRequest::imports`](skiagraph_graph::PlanRequest::imports). Its content counts as
    /// changed.
    ///
    /// # Errors
    /// If the plan has no such import, the texture is not as described, or it is another one and
    /// the device is lost.
    pub fn import_texture(
        &mut self,
        name: &str,
        texture: &wgpu::Texture,
    ) -> Result<(), ExecuteError> {
        self.import(name, Physical::Texture(texture.clone()))
    }

    /// Hands over a buffer; see [`import_texture`](Self::import_texture).
    ///
    /// # Errors
    /// Those of [`import_texture`](Self::import_texture).
    pub fn import_buffer(&mut self, name: &str, buffer: &wgpu::Buffer) -> Result<(), ExecuteError> {
        self.import(name, Physical::Buffer(buffer.clone()))
    }

    /// Hands over a sampler; see [`import_texture`](Self::import_texture). wgpu does not tell how
    /// it filters: what disagrees with the description is refused where it is bound.
    ///
    /// # Errors
    /// Those of [`import_texture`](Self::import_texture).
    pub fn import_sampler(
        &mut self,
        name: &str,
        sampler: &wgpu::Sampler,
    ) -> Result<(), ExecuteError> {
        self.import(name, Physical::Sampler(sampler.clone()))
    }

    fn import(&mut self, name: &str, physical: Physical) -> Result<(), ExecuteError> {
        let imports = self.plan().imports();
        let Some(described) = imports.get(name) else {
            let known: Vec<&str> = imports.keys().map(String::as_str).collect();
            return Err(ExecuteError::NoSuchImport {
                name: name.to_owned(),
                known: list(&known),
            });
        };
        if let Some(why) = differs(&physical, described) {
            return Err(ExecuteError::Import {
                name: name.to_owned(),
                why,
            });
        }
        // One that no live pass uses waits for a plan in which one does.
        let Some(id) = self.state.live(name) else {
            self.state.memory.spare(name, physical);
            return Ok(());
        };
        // Most hosts hand over the same texture in every frame.
        if self.state.memory.host(id) != Some(&physical) {
            self.presence.check()?;
        }
        self.state.contents.touch(id);
        if self.state.memory.import(id, physical) {
            self.state.unbind(id);
        }
        Ok(())
    }

    /// Tells that the content of an import or provided resource has changed, so that passes with
    /// `run: OnChange` that read it run in the next frame, and that the one after it finds this
    /// content as `.previous`. (A provider that counts [`versions`](Provider::version) needs
    /// [`refresh`](Self::refresh) instead.)
    ///
    /// # Errors
    /// If the plan has nothing of the host's under this name. (One that no live pass uses is fine.)
    pub fn touch(&mut self, name: &str) -> Result<(), ExecuteError> {
        let of_host = |resource: &Resource| resource.origin == Origin::Host;
        if !self.plan().imports().contains_key(name) {
            self.host_changes.touch(name);
        }
        let live = self.state.live(name);
        if let Some(id) = live.filter(|id| of_host(self.plan().resource(*id))) {
            self.state.contents.touch(id);
        } else if !self.plan().offers(name) {
            let used = self.plan().used().filter(|used| of_host(used));
            let used: Vec<&str> = used.map(|resource| resource.name.as_str()).collect();
            return Err(ExecuteError::NotOfHost {
                name: name.to_owned(),
                known: list(&used),
            });
        }
        Ok(())
    }

    /// Asks the provider again for every resource whose [version](Provider::version) has changed
    /// since it was last asked, and for those that it could not build the last time. Frames that
    /// were encoded before keep what they were encoded with.
    ///
    /// # Errors
    /// If one cannot be built, or is described otherwise than when the graph was planned (more
    /// items, say, or a light of another kind: [`ExecuteError::OtherThanPlanned`]), or the device
    /// is lost. The rest stays as it was and is asked for again the next time.
    pub fn refresh(&mut self, provider: &mut dyn Provider) -> Result<(), ExecuteError> {
        let refreshed = self.refresh_live(provider);
        if refreshed.is_ok() {
            self.note_changes(provider);
        } else {
            self.host_changes.touch_all();
        }
        refreshed
    }

    /// Notes what of the provider's has changed, after live passes have what they bind of it.
    fn note_changes(&mut self, provider: &dyn Provider) {
        match self.state.uniform {
            Some(_) => self.host_changes.compare(provider),
            None => self.host_changes.forget(),
        }
    }

    fn refresh_live(&mut self, provider: &mut dyn Provider) -> Result<(), ExecuteError> {
        for (id, version) in self.state.memory.provided().clone() {
            let state = &mut self.state;
            if Ok(provider.version(&state.plan.resource(id).name)) == version {
                continue;
            }
            self.presence.check()?;
            let before = state.memory.host(id).cloned();
            let mut factory = ResourceFactory {
                device: &self.device,
                queue: &self.queue,
                provider: &mut *provider,
            };
            state.memory.refresh(id, &state.plan, None, &mut factory)?;
            state.contents.touch(id);
            let now = state.memory.host(id);
            if now.is_some() {
                self.host_changes.touch(&state.plan.resource(id).name);
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

    /// An output or capture as the last frame left it, for the host to bind. A resource that is
    /// also read as it was in the frame before has another view in every frame, and
    /// [`resize`](Self::resize) and the like make new ones.
    pub fn output_view(&self, name: &str) -> Option<wgpu::TextureView> {
        let target = self.plan().readable_target(name)?;
        let dimension = match &self.plan().resource(target.id).kind {
            ResourceKind::Texture(texture) if texture.is_3d => wgpu::TextureViewDimension::D3,
            _ if target.part.layers.len() == 1 => wgpu::TextureViewDimension::D2,
            _ => wgpu::TextureViewDimension::D2Array,
        };
        self.state
            .memory
            .view(target, dimension, &self.ping_pong)
            .ok()
    }

    /// A buffer among the outputs and captures as the last frame left it.
    pub fn output_buffer(&self, name: &str) -> Option<wgpu::Buffer> {
        let target = self.plan().readable_target(name)?;
        self.state
            .memory
            .buffer(target.id, &self.ping_pong)
            .ok()
            .cloned()
    }

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
    fn put_in(
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
        let memory = memory.map_err(|error| with_table(error, &plan))?;
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

    /// Returns the [`Preparer`] with which another thread [`prepare`s](Preparer::prepare) the next
    /// graph while this one is drawn.
    pub fn preparer(&self) -> Preparer {
        let steps = |pass: &LinkedPass| (pass.name.value.clone(), pass.steps.clone());
        Preparer {
            device: self.device.clone(),
            pipelines: self.pipelines.clone(),
            known: self.plan().live().map(steps).collect(),
        }
    }

    /// [`replace_graph`](Self::replace_graph) with a plan whose pipelines are there. Parts that the
    /// plan has changed since the [`preparer`](Self::preparer) was taken are made now.
    ///
    /// # Errors
    /// Those of [`replace_graph`](Self::replace_graph). The executor is as it was then.
    pub fn replace(
        &mut self,
        prepared: Prepared,
        provider: &mut dyn Provider,
    ) -> Result<ReplanReport, ExecuteError> {
        let Prepared { plan, pipelines } = prepared;
        self.pipelines = pipelines;
        let report = self.replace_graph(plan, provider);
        self.pipelines.forget_prepared();
        report
    }

    /// Makes buffers and textures larger that have `grow` and were too small for a frame that is
    /// done, as the next [`encode`](Self::encode) would do; for a host that wants the new plan at a
    /// time of its own, or to know of it. It never waits: a counter that has not arrived is looked
    /// at the next time. `None` if there was nothing to do. Where the memory limit or the device
    /// refuses more, what the document does for items that have no room holds, and nothing is tried
    /// until the plan changes otherwise.
    ///
    /// # Errors
    /// If the device was lost, or a provided resource that has changed cannot be built. The
    /// executor is as it was then, and the next frame asks again.
    pub fn grow(
        &mut self,
        provider: &mut dyn Provider,
    ) -> Result<Option<ReplanReport>, ExecuteError> {
        if !self
            .state
            .growth_readbacks
            .iter()
            .any(GrowthReadback::is_asked)
        {
            return Ok(None);
        }
        poll(&self.device, wgpu::PollType::Poll)?;
        let Some(plan) = self.larger() else {
            return Ok(None);
        };
        let report = self.grow_to(plan, provider)?;
        if report.is_some() {
            self.note_changes(provider);
        }
        Ok(report)
    }

    /// The same with what the executor has of the provider, by the counters that submissions have
    /// brought.
    fn grow_by_itself(&mut self) -> Result<(), ExecuteError> {
        let Some(plan) = self.larger() else {
            return Ok(());
        };
        let known = self.state.memory.provided().iter();
        let known =
            known.map(|(id, version)| (self.plan().resource(*id).name.clone(), version.clone()));
        let mut unchanged = Unchanged(known.collect());
        self.grow_to(plan, &mut unchanged).map(drop)
    }

    /// The plan with room for all that frames which are done have asked for; `None` if they had it.
    fn larger(&mut self) -> Option<Result<Plan, ExecuteError>> {
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

    fn grow_to(
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
            report => report.map(Some),
        }
    }
}

/// Refuses a plan whose graph is not proven on the device's backend.
pub(super) fn check_backend(device: &wgpu::Device, plan: &Plan) -> Result<(), ExecuteError> {
    if let Some(backend) = partial(device.adapter_info().backend) {
        plan.check_backend(&backend)?;
    }
    Ok(())
}

/// Names for a message.
pub(super) fn list(names: &[&str]) -> String {
    if names.is_empty() {
        "none".to_owned()
    } else {
        names.join(", ")
    }
}

impl std::fmt::Debug for Executor {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Executor")
            .field("plan", self.plan())
            .finish_non_exhaustive()
    }
}
