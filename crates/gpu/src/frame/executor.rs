//! A plan on a device, and its frames.

use super::{
    contents::{Contents, HostCopy},
    encode::encode_all,
    pass::GpuPass,
    poison::Poison,
    watch::Watch,
};
use crate::{
    error::{ExecuteError, check_device_lost, scoped, wait, with_table},
    memory::{
        memory::{Maker, Memory},
        physical::PingPong,
    },
    pipelines::pipelines::Pipelines,
    provider::Provider,
    readback::{Pending, Readback},
    timing::{timer::Timer, times::FrameTiming},
};
use skiagraph_graph::{FRAME_BYTES, Origin, Plan, ResourceId, ResourceKind};
use std::{
    sync::Arc,
    time::{Duration, Instant},
};

/// What a frame is asked for.
#[derive(Clone, Copy, Debug, Default)]
pub struct Frame<'a> {
    /// Take GPU timestamps.
    pub timing: bool,
    /// Run every pass, also those of which nothing that they read has changed.
    pub all: bool,
    /// Outputs and captures to read back.
    pub read: &'a [&'a str],
    /// The time of what is shown, seconds: `frame.seconds` of the shaders.
    pub seconds: f32,
}

/// What a frame brought.
#[derive(Clone, Debug, Default)]
pub struct FrameReport {
    /// Times, if they were asked for.
    pub timing: Option<FrameTiming>,
    /// The passes that did not run because their run condition said so, in schedule order.
    pub skipped: Vec<String>,
    /// Contents, in the order in which they were asked for.
    pub readbacks: Vec<Readback>,
}

/// A plan on a device.
///
/// A frame is [`encode`](Self::encode), the host's submission, [`submitted`](Self::submitted), and,
/// for times and readbacks, [`finish`](Self::finish). Every encoder that a frame was encoded into
/// must be submitted, in order: what a skipped pass or `.previous` finds was made there.
pub struct Executor {
    pub(super) device: wgpu::Device,
    pub(super) queue: wgpu::Queue,
    pub(super) pipelines: Pipelines,
    pub(super) state: State,
    /// Whose turn it was in the frame that was encoded last.
    pub(super) ping_pong: PingPong,
    /// Frames that were encoded.
    frames: u32,
    timer: Timer,
    timed: bool,
    /// The passes of the last frame, if it was timed, with the time that encoding them took. Names,
    /// because the next plan may have other passes.
    cpu: Vec<(Arc<str>, Duration)>,
    skipped: Vec<Arc<str>>,
    pending: Vec<Pending>,
}

/// A plan and what was made for it; another plan has another one.
pub(super) struct State {
    pub plan: Plan,
    pub memory: Memory,
    /// The passes of the schedule.
    pub passes: Vec<GpuPass>,
    pub contents: Contents,
    pub poison: Option<Poison>,
    /// Buffers that may grow.
    pub watches: Vec<Watch>,
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
        check_device_lost(device)?;
        let mut pipelines = Pipelines::default();
        let mut maker = Maker {
            device,
            queue,
            provider,
        };
        let state = State::new(plan, &mut pipelines, &mut maker)?;
        let mut executor = Self {
            device: device.clone(),
            queue: queue.clone(),
            pipelines,
            ping_pong: state.ping_pong(true),
            state,
            frames: 0,
            timer: Timer::new(device, queue)?,
            timed: false,
            cpu: Vec::new(),
            skipped: Vec::new(),
            pending: Vec::new(),
        };
        executor.state.bind_what_can_be(device)?;
        Ok(executor)
    }

    /// The plan.
    pub fn plan(&self) -> &Plan {
        &self.state.plan
    }

    /// Encodes a frame. The host submits the encoder and then calls [`Executor::submitted`].
    ///
    /// # Errors
    /// If an output is asked for that the plan does not have, an import is missing, the device is
    /// lost or has no memory to read something back, or refuses a pass that is bound in this frame
    /// for the first time. Nothing has been encoded then.
    pub fn encode(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        frame: &Frame<'_>,
    ) -> Result<(), ExecuteError> {
        check_device_lost(&self.device)?;
        let uniform = self.frame_uniform(frame.seconds)?;
        let state = &mut self.state;
        let runs = state
            .contents
            .running(&state.plan, &state.passes, frame.all);
        let ping_pong = state.contents.ping_pong(&state.plan, &runs);
        state.bind(&runs, &ping_pong, &self.device)?;
        let pending = state.pending(frame.read, &ping_pong, &self.device)?;
        self.timed = frame.timing;
        if self.timed {
            self.timer.open(&self.device)?;
        }
        self.cpu.clear();
        self.skipped.clear();
        // From here on nothing can fail.
        if let Some((staging, uniform)) = uniform {
            encoder.copy_buffer_to_buffer(&staging, 0, &uniform, 0, FRAME_BYTES);
        }
        let copies = state.contents.first_copies(&state.plan);
        state.copy_host(&copies, encoder);
        for (at, pass) in state.passes.iter().enumerate() {
            if !runs[at] {
                self.skipped.push(pass.name.clone());
                continue;
            }
            let start = frame.timing.then(Instant::now);
            if let Some(poison) = &state.poison {
                poison.fill(at, &ping_pong, encoder);
            }
            let steps = pass.steps(&ping_pong).unwrap_or_default();
            let timer = frame.timing.then_some(&self.timer);
            encode_all(steps, &pass.name, encoder, timer);
            if let Some(start) = start {
                self.cpu.push((pass.name.clone(), start.elapsed()));
            }
        }
        if frame.timing {
            self.timer.resolve(encoder);
        }
        pending.iter().for_each(|pending| pending.copy(encoder));
        self.pending = pending;
        for watch in &mut state.watches {
            watch.copy(&state.plan, &state.memory, &ping_pong, encoder);
        }
        state
            .contents
            .ran(&state.plan, &mut state.passes, &runs, &ping_pong);
        let copies = state.contents.copies(&state.plan);
        state.copy_host(&copies, encoder);
        self.ping_pong = ping_pong;
        self.frames = self.frames.wrapping_add(1);
        Ok(())
    }

    /// The uniform `frame` and what it is to hold, if a live pass reads it. The host may encode
    /// several frames before it submits the first, so each brings its own copy.
    fn frame_uniform(
        &mut self,
        seconds: f32,
    ) -> Result<Option<(wgpu::Buffer, wgpu::Buffer)>, ExecuteError> {
        let State {
            plan,
            memory,
            contents,
            ..
        } = &mut self.state;
        let mut live = plan.schedule().lifetimes.keys();
        let is_frame = |id: &&ResourceId| matches!(plan.resource(**id).kind, ResourceKind::Frame);
        let Some(&id) = live.find(is_frame) else {
            return Ok(None);
        };
        let staging = scoped(&self.device, "frame", || {
            self.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("frame"),
                size: FRAME_BYTES,
                usage: wgpu::BufferUsages::COPY_SRC,
                mapped_at_creation: true,
            })
        })?;
        let mut bytes = [0; FRAME_BYTES as usize];
        bytes[..4].copy_from_slice(&self.frames.to_ne_bytes());
        bytes[4..8].copy_from_slice(&seconds.to_ne_bytes());
        match staging.get_mapped_range_mut(..) {
            Ok(mut mapped) => mapped.copy_from_slice(&bytes),
            Err(_) => return Err(ExecuteError::Internal("the uniform `frame` was not mapped")),
        }
        staging.unmap();
        contents.touch(id);
        let uniform = memory.buffer(id, &self.ping_pong)?.clone();
        Ok(Some((staging, uniform)))
    }

    /// Ends the timing frame and starts the readbacks, after the host has submitted the encoder.
    ///
    /// # Errors
    /// If timestamps could not be taken.
    pub fn submitted(&mut self) -> Result<(), ExecuteError> {
        if self.timed {
            self.timer.submitted()?;
        }
        self.pending.iter_mut().for_each(Pending::map);
        self.state.watches.iter_mut().for_each(Watch::map);
        Ok(())
    }

    /// Waits until the submitted frame is done and hands out its times and readbacks.
    ///
    /// # Errors
    /// If the device was lost.
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
        if !wait(&self.device, timeout)? {
            return Err(ExecuteError::Unfinished {
                after: began.elapsed(),
                passes: list(&self.ran()),
            });
        }
        // A device that was destroyed is waited for without complaint, but has no query buffers to
        // take times from.
        check_device_lost(&self.device)?;
        let timing = self.timed.then(|| self.timer.take(&self.cpu));
        let readbacks = std::mem::take(&mut self.pending)
            .into_iter()
            .map(Pending::take)
            .collect::<Result<_, _>>()?;
        Ok(FrameReport {
            timing,
            skipped: self.skipped.iter().map(|name| name.to_string()).collect(),
            readbacks,
        })
    }

    /// Names of the passes of the last frame.
    fn ran(&self) -> Vec<&str> {
        let passes = self.state.passes.iter().map(|pass| &*pass.name);
        let ran = passes.filter(|name| self.skipped.iter().all(|skipped| **skipped != **name));
        ran.collect()
    }
}

impl State {
    fn new(
        plan: Plan,
        pipelines: &mut Pipelines,
        maker: &mut Maker<'_>,
    ) -> Result<Self, ExecuteError> {
        let refused = |error| with_table(error, &plan);
        let memory = Memory::new(&plan, None, maker).map_err(refused)?;
        let passes = (0..plan.schedule().passes.len())
            .map(|at| GpuPass::new(&plan, at, None, pipelines, maker.device))
            .collect::<Result<Vec<_>, _>>()
            .map_err(refused)?;
        Ok(Self {
            poison: Poison::new(&plan, &memory, maker.device).map_err(refused)?,
            watches: Watch::all(&plan, maker.device).map_err(refused)?,
            contents: Contents::of(&plan, 0),
            memory,
            passes,
            plan,
        })
    }

    /// Whose turn it is in a frame in which every pass runs, or none.
    pub fn ping_pong(&self, runs: bool) -> PingPong {
        self.contents
            .ping_pong(&self.plan, &vec![runs; self.passes.len()])
    }

    /// The resource of a name that a live pass uses.
    pub fn live(&self, name: &str) -> Option<ResourceId> {
        let mut live = self.plan.schedule().lifetimes.keys();
        live.find(|id| self.plan.resource(**id).name == name)
            .copied()
    }

    /// Forgets what the passes that use a resource have bound.
    pub fn unbind(&mut self, id: ResourceId) {
        for (pass, made) in self.plan.live().zip(&mut self.passes) {
            if pass.accesses.iter().any(|access| access.resource == id) {
                made.unbind();
            }
        }
    }

    /// Binds the passes that run and are not bound for this state of the ping-pong.
    fn bind(
        &mut self,
        runs: &[bool],
        ping_pong: &PingPong,
        device: &wgpu::Device,
    ) -> Result<(), ExecuteError> {
        for (at, made) in self.passes.iter_mut().enumerate() {
            if !runs[at] || made.is_bound(ping_pong) {
                continue;
            }
            if let Some(name) = missing_import(&self.plan, &self.memory, at) {
                let pass = &self.plan.pass(self.plan.schedule().passes[at]).name;
                return Err(ExecuteError::NotImported {
                    name,
                    pass: pass.value.clone(),
                    place: pass.span.to_string(),
                });
            }
            made.bind(&self.plan, at, &self.memory, ping_pong, device)?;
        }
        Ok(())
    }

    /// Binds every pass whose imports are there, as a frame in which all run will need it.
    pub fn bind_what_can_be(&mut self, device: &wgpu::Device) -> Result<(), ExecuteError> {
        let ready: Vec<bool> = (0..self.passes.len())
            .map(|at| missing_import(&self.plan, &self.memory, at).is_none())
            .collect();
        self.bind(&ready, &self.ping_pong(true), device)
    }

    /// The readbacks of a frame; the staging buffers are made here, and there may be no memory.
    fn pending(
        &self,
        names: &[&str],
        ping_pong: &PingPong,
        device: &wgpu::Device,
    ) -> Result<Vec<Pending>, ExecuteError> {
        let pending = |name: &&str| {
            let make = || Pending::new(device, &self.plan, &self.memory, ping_pong, name);
            scoped(device, name, make).map_err(|error| with_table(error, &self.plan))?
        };
        names.iter().map(pending).collect()
    }

    /// Copies what the host provides to where the next frame finds it as it was in this one.
    fn copy_host(&self, copies: &[HostCopy], encoder: &mut wgpu::CommandEncoder) {
        for (base, copy) in copies {
            let none = PingPong::new();
            let buffers = [base, copy].map(|id| self.memory.buffer(*id, &none));
            if let [Ok(base), Ok(copy)] = buffers {
                encoder.copy_buffer_to_buffer(base, 0, copy, 0, base.size().min(copy.size()));
            }
        }
    }
}

/// Names for a message.
pub(super) fn list(names: &[&str]) -> String {
    match names.is_empty() {
        true => "none".to_owned(),
        false => names.join(", "),
    }
}

/// An import that a pass uses and the host has not handed over.
fn missing_import(plan: &Plan, memory: &Memory, at: usize) -> Option<String> {
    let mut accesses = plan.pass(plan.schedule().passes[at]).accesses.iter();
    let missing = accesses.find(|access| {
        plan.resource(access.resource).origin == Origin::Host
            && memory.host(access.resource).is_none()
    })?;
    Some(plan.resource(missing.resource).name.clone())
}

impl std::fmt::Debug for Executor {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Executor")
            .field("plan", self.plan())
            .finish_non_exhaustive()
    }
}
