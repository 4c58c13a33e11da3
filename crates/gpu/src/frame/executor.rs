//! A plan on a device, and its frames.

use super::{
    fetch::Fetch,
    host_changes::HostChanges,
    in_flight::{FrameInFlight, FramesInFlight, names},
    report::{Frame, FrameReport},
    state::{FrameDecision, State},
    uniform::FrameUniform,
};
use crate::{
    device::partial,
    error::{ExecuteError, poll, wait, with_table},
    memory::{memory::ResourceFactory, physical::PingPong},
    pipelines::pipelines::Pipelines,
    presence::Presence,
    provider::Provider,
    timing::{statistics::Counters, timer::Timer},
};
use skiagraph_graph::Plan;
use std::{
    sync::Arc,
    time::{Duration, Instant},
};

/// How long it is waited for another thread that polls the device to say what is done.
const CALLBACK: Duration = Duration::from_secs(10);

/// A plan on a device.
///
/// A frame is [`encode`](Self::encode), the host's submission, and, for times and readbacks,
/// [`poll`](Self::poll) in this frame or a later one, or [`finish`](Self::finish), which waits.
/// Every encoder that a frame was encoded into must be submitted, in order: what a skipped pass or
/// `.previous` finds was made there.
pub struct Executor {
    pub(super) device: wgpu::Device,
    pub(super) presence: Presence,
    pub(super) queue: wgpu::Queue,
    pub(super) pipelines: Pipelines,
    pub(super) state: State,
    /// Whose turn it was in the frame that was encoded last.
    pub(super) ping_pong: PingPong,
    decision: FrameDecision,
    pub(super) host_changes: HostChanges,
    /// Frames that were encoded.
    frames: u32,
    pub(super) frames_in_flight: FramesInFlight,
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
