//! A plan with its memory, passes and contents on a device.

use super::clears;
use super::contents::{Contents, HostCopy};
use super::cpu::CpuTurn;
use super::encode::{Meters, SharedPass, clear_buffers, encode_all, layers_from};
use super::fetch::Readable;
use super::growth_readback::GrowthReadback;
use super::idle::Idle;
use super::in_flight::FrameInFlight;
use super::pass::GpuPass;
use super::poison::Poison;
use super::statistics::Counters;
use crate::error::{ExecuteError, with_table};
use crate::memory::memory::{Grown, InFrame, Memory, ResourceFactory};
use crate::memory::physical::{Physical, PingPong};
use crate::pipelines::pipelines::Pipelines;
use skiagraph_graph::{Ids, LinkedPass, Origin, Plan, ResourceId, ResourceKind, step::Step};
use std::sync::Arc;
use web_time::Instant;

/// A plan and everything that was created for it on the device.
pub(super) struct State {
    pub plan: Plan,
    pub memory: Memory,
    /// The passes in schedule order.
    pub passes: Vec<GpuPass>,
    /// First position that the clears of each pass may be moved to; see [`clears::earliest`].
    clears: Vec<Option<usize>>,
    pub contents: Contents,
    pub idle: Idle,
    pub poison: Option<Poison>,
    /// The buffers and textures that may grow.
    pub growth_readbacks: Vec<GrowthReadback>,
    /// The outputs and captures.
    pub readables: Vec<Arc<Readable>>,
    /// The uniform `frame`; `None` if no live pass reads it.
    pub uniform: Option<ResourceId>,
    /// Contents to copy into larger resources before the next frame's passes, in this order.
    pub grown: Vec<Grown>,
}

/// Decision about a frame. It is reused for every frame, to save allocations.
#[derive(Default)]
pub(super) struct FrameDecision {
    /// True for each pass of the schedule that runs.
    pub runs: Vec<bool>,
    /// True if no pass runs because the outputs of an earlier frame are right.
    pub rests: bool,
    pub ping_pong: PingPong,
}

impl State {
    pub fn new(
        plan: Plan,
        pipelines: &Pipelines,
        factory: &mut ResourceFactory<'_>,
    ) -> Result<Self, ExecuteError> {
        let refused = |error| with_table(error, &plan);
        let memory = Memory::new(&plan, None, factory).map_err(refused)?;
        let _in_use = pipelines.of_passes(plan.live()).map_err(refused)?;
        let passes = (0..plan.schedule().passes.len())
            .map(|at| GpuPass::new(&plan, at, None, pipelines))
            .collect::<Result<Vec<_>, _>>()
            .map_err(refused)?;
        let contents = Contents::new(&plan, 0);
        Self::of(plan, memory, passes, contents, factory.device)
    }

    /// Builds the state from memory, passes and contents that were created for the plan.
    pub fn of(
        plan: Plan,
        mut memory: Memory,
        passes: Vec<GpuPass>,
        contents: Contents,
        device: &wgpu::Device,
    ) -> Result<Self, ExecuteError> {
        let refused = |error| with_table(error, &plan);
        Ok(Self {
            poison: Poison::new(&plan, &memory, device).map_err(refused)?,
            growth_readbacks: GrowthReadback::all(&plan, device).map_err(refused)?,
            readables: Readable::all(&plan),
            uniform: frame_uniform(&plan),
            grown: memory.take_grown(),
            clears: clears::earliest(&plan),
            idle: Idle::new(&plan),
            contents,
            memory,
            passes,
            plan,
        })
    }

    /// Returns the ping-pong state of a frame in which every pass runs, or none if `runs` is false.
    pub fn ping_pong(&self, runs: bool) -> PingPong {
        let mut decision = PingPong::new();
        let runs = vec![runs; self.passes.len()];
        self.contents.ping_pong(&self.plan, &runs, &mut decision);
        decision
    }

    /// Notes that the host has changed the content of a resource.
    pub fn touch(&mut self, id: ResourceId) {
        self.idle.note_change();
        self.contents.touch(id);
    }

    /// Sets other params of the pass at position `at` of the schedule; see [`GpuPass::set_params`].
    pub fn set_params(&mut self, at: usize, params: Vec<Option<wgpu::Buffer>>) {
        self.idle.note_change();
        self.contents.stale[at] = true;
        self.passes[at].set_params(params);
    }

    /// Returns the resource of this name that a live pass uses.
    pub fn live(&self, name: &str) -> Option<ResourceId> {
        let mut live = self.plan.schedule().lifetimes.keys();
        live.find(|id| self.plan.resource(**id).name == name)
            .copied()
    }

    /// Drops the bindings of the passes that use a resource.
    pub fn unbind(&mut self, id: ResourceId) {
        self.users(id).for_each(GpuPass::unbind);
    }

    /// Drops the bindings of the passes that use a buffer that was replaced by one of the same size
    /// and usage.
    pub fn rebind(&mut self, id: ResourceId) {
        self.users(id).for_each(GpuPass::rebind);
    }

    fn users(&mut self, id: ResourceId) -> impl Iterator<Item = &mut GpuPass> {
        let passes = self.plan.live().zip(&mut self.passes);
        let uses = move |pass: &LinkedPass| pass.accesses.iter().any(|it| it.resource == id);
        passes.filter_map(move |(pass, made)| uses(pass).then_some(made))
    }

    /// Binds the passes that run and are not yet bound for this state of the ping-pong.
    pub fn bind(
        &mut self,
        runs: &[bool],
        ping_pong: &PingPong,
        device: &wgpu::Device,
    ) -> Result<(), ExecuteError> {
        let (plan, memory) = (&self.plan, &self.memory);
        let frame = InFrame::new(plan, memory, ping_pong);
        for (at, made) in self.passes.iter_mut().enumerate() {
            if !runs[at] || made.is_bound(ping_pong) {
                continue;
            }
            if let Some(id) = missing(plan, memory, at) {
                return Err(not_there(plan, memory, id, at));
            }
            let bound = made.bind(at, frame, device);
            bound.map_err(|error| with_table(error, plan))?;
        }
        Ok(())
    }

    /// Binds every pass whose imports and provided resources exist, for a frame in which all passes
    /// run.
    pub fn bind_what_can_be(&mut self, device: &wgpu::Device) -> Result<(), ExecuteError> {
        let is_ready = |at| missing(&self.plan, &self.memory, at).is_none();
        let ready: Vec<bool> = (0..self.passes.len()).map(is_ready).collect();
        self.bind(&ready, &self.ping_pong(true), device)
    }

    /// Notes that a frame that began with the contents `before` has failed when some of its passes
    /// had run: all of them run again.
    pub fn forget_frame(&mut self, decision: &FrameDecision, before: &Contents) {
        self.idle.note_change();
        self.contents.rewind(&self.plan, before);
        for (seen, runs) in self.contents.seen.iter_mut().zip(&decision.runs) {
            seen.take_if(|_| *runs);
        }
    }

    /// Decides which passes run in the next frame, which has the number `frame`, and which
    /// allocations they use. None runs if `may_rest` is set and nothing has changed since a frame
    /// that is done.
    pub fn decide(
        &mut self,
        (frame, forced): (u32, bool),
        may_rest: bool,
        decision: &mut FrameDecision,
    ) {
        // Its content is another one in every frame.
        if let Some(uniform) = self.uniform {
            self.contents.touch(uniform);
        }
        decision.rests = may_rest && self.idle.is_settled();
        let runs = &mut decision.runs;
        if decision.rests {
            runs.clear();
            runs.resize(self.passes.len(), false);
        } else {
            self.contents
                .running(&self.plan, &self.passes, (frame, forced), runs);
        }
        let ping_pong = &mut decision.ping_pong;
        self.contents.ping_pong(&self.plan, runs, ping_pong);
    }

    /// Returns the first pass that works on the CPU.
    pub fn on_cpu(&self) -> Option<&LinkedPass> {
        let is_cpu = |step: &Step<Ids>| matches!(step, Step::Cpu(_));
        self.plan.live().find(|pass| pass.steps.iter().any(is_cpu))
    }

    /// Encodes the passes that run and lists the others in `skipped`. In a timed frame it takes
    /// their times.
    ///
    /// # Errors
    /// Those of work for the CPU.
    pub fn encode(
        &self,
        decision: &FrameDecision,
        frame_in_flight: &mut FrameInFlight,
        encoder: &mut wgpu::CommandEncoder,
        mut cpu: Option<&mut CpuTurn<'_>>,
    ) -> Result<(), ExecuteError> {
        let timer = frame_in_flight.timer.as_ref();
        let timer = timer.filter(|_| frame_in_flight.is_timed);
        let counters = &mut frame_in_flight.counters;
        let is_measured = timer.is_some() || counters.is_some();
        let may_share = !is_measured && self.poison.is_none();
        let mut shared = SharedPass::default();
        let mut shared_until = 0;
        for (at, pass) in self.passes.iter().enumerate() {
            if !decision.runs[at] {
                frame_in_flight.skipped.push(pass.name.clone());
                continue;
            }
            let steps = pass.steps(&decision.ping_pong).unwrap_or_default();
            if may_share && self.clears[at].is_some() {
                if at >= shared_until {
                    shared.end();
                    shared_until = self.clear_ahead(at, decision, encoder);
                }
                shared.dispatch(steps, &pass.name, encoder);
                continue;
            }
            shared.end();
            let start = timer.map(|_| Instant::now());
            if let Some(poison) = &self.poison {
                poison.fill(at, &decision.ping_pong, encoder);
            }
            let first = counters.as_ref().map_or(0, Counters::used);
            let meters = Meters {
                timer,
                counters: counters.as_ref(),
            };
            encode_all(steps, &pass.name, encoder, meters, cpu.as_deref_mut())?;
            if let Some(counters) = counters {
                counters.pass(pass.name.clone(), first);
            }
            if let Some(start) = start {
                let worked = cpu.as_mut().and_then(|cpu| cpu.worked.take());
                let time = worked.unwrap_or_else(|| start.elapsed());
                frame_in_flight.cpu.push((pass.name.clone(), time));
            }
        }
        Ok(())
    }

    /// Encodes the clears of the pass at position `at` and of all that can share its compute pass,
    /// as their clears may come before it. Returns the position after these passes.
    fn clear_ahead(
        &self,
        at: usize,
        decision: &FrameDecision,
        encoder: &mut wgpu::CommandEncoder,
    ) -> usize {
        let mut until = at;
        for (pass, runs) in self.passes[at..].iter().zip(&decision.runs[at..]) {
            if *runs {
                if self.clears[until].is_none_or(|first| first > at) {
                    break;
                }
                let steps = pass.steps(&decision.ping_pong);
                clear_buffers(steps.unwrap_or_default(), encoder);
            }
            until += 1;
        }
        until
    }

    /// Copies contents into the larger buffers and textures that replaced smaller ones since the
    /// last frame.
    pub fn copy_grown(&self, encoder: &mut wgpu::CommandEncoder) {
        for pair in &self.grown {
            match pair {
                (Physical::Buffer(from), Physical::Buffer(to)) => {
                    encoder.copy_buffer_to_buffer(from, 0, to, 0, from.size());
                }
                (Physical::Texture(from), Physical::Texture(to)) => {
                    for mip in 0..from.mip_level_count() {
                        let [source, target] = [from, to].map(|it| layers_from(it, mip, 0));
                        let size = from.size().mip_level_size(mip, from.dimension());
                        encoder.copy_texture_to_texture(source, target, size);
                    }
                }
                _ => {}
            }
        }
    }

    /// Copies a provided resource to the buffer that the next frame reads as `.previous`.
    pub fn copy_host(memory: &Memory, (base, copy): HostCopy, encoder: &mut wgpu::CommandEncoder) {
        let none = PingPong::new();
        let buffers = [base, copy].map(|id| memory.buffer(id, &none));
        if let [Ok(base), Ok(copy)] = buffers {
            encoder.copy_buffer_to_buffer(base, 0, copy, 0, base.size().min(copy.size()));
        }
    }
}

/// Returns the uniform `frame`, if a live pass reads it.
fn frame_uniform(plan: &Plan) -> Option<ResourceId> {
    let mut live = plan.schedule().lifetimes.keys();
    let is_frame = |id: &&ResourceId| matches!(plan.resource(**id).kind, ResourceKind::Frame);
    live.find(is_frame).copied()
}

/// Returns a resource of the host that the pass at position `at` uses, directly or as `.previous`,
/// and that does not exist yet: an unset import, or one that the provider cannot build. `None` if
/// all exist.
fn missing(plan: &Plan, memory: &Memory, at: usize) -> Option<ResourceId> {
    let accesses = plan.pass(plan.schedule().passes[at]).accesses.iter();
    let mut of_host = accesses.filter_map(|access| {
        let id = access.resource;
        match plan.resource(id).origin {
            Origin::Host => Some(id),
            Origin::Previous(base) => (plan.resource(base).origin == Origin::Host).then_some(base),
            _ => None,
        }
    });
    of_host.find(|id| memory.host(*id).is_none())
}

/// Returns the error of a pass that needs a missing resource of the host.
fn not_there(plan: &Plan, memory: &Memory, id: ResourceId, at: usize) -> ExecuteError {
    let name = plan.resource(id).name.clone();
    let pass = &plan.pass(plan.schedule().passes[at]).name;
    let (pass, place) = (pass.value.clone(), pass.span.to_string());
    match memory.missing(id) {
        Some(why) => ExecuteError::NotProvided {
            name,
            pass,
            place,
            why: why.to_owned(),
        },
        None => ExecuteError::NotImported { name, pass, place },
    }
}
