//! Phase 10: the passes are encoded into the host's encoder; timing and readback end after submission.

mod adopt;
mod encode;
mod error;
mod incremental;
mod pass;
mod poison;

pub use adopt::Renewed;
pub use error::ExecuteError;
pub(crate) use error::scoped;

use crate::{
    allocate::Pipelines,
    memory::{Histories, Memory, Physical, differs},
    plan::Plan,
    provider::Provider,
    readback::{Pending, Readback},
    resolve::{Origin, Resource, ResourceId},
    timing::{FrameTiming, Timer},
};
use encode::encode_all;
use error::{alive, wait, with_table};
use incremental::Contents;
use pass::MadePass;
use poison::Poison;
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
/// A frame is [`encode`](Self::encode), the host's submission, [`submitted`](Self::submitted), and, for times and readbacks,
/// [`finish`](Self::finish). Every encoder that a frame was encoded into must be submitted, in order: what a skipped pass or
/// `Previous` finds was made there.
pub struct Executor {
    device: wgpu::Device,
    queue: wgpu::Queue,
    plan: Plan,
    memory: Memory,
    pipelines: Pipelines,
    /// The passes of the schedule.
    passes: Vec<MadePass>,
    contents: Contents,
    /// The state of the histories in the frame that was encoded last.
    histories: Histories,
    poison: Option<Poison>,
    timer: Timer,
    timed: bool,
    /// The passes of the last frame, if it was timed, with the time that encoding them took. Names, because the next plan may have
    /// other passes.
    cpu: Vec<(Arc<str>, Duration)>,
    skipped: Vec<Arc<str>>,
    pending: Vec<Pending>,
}

impl Executor {
    /// Makes what the plan needs on the device, asks the provider for what live passes bind, and encodes every pass once
    /// into a throw-away encoder, so that whatever the device refuses is refused here. (A pass that uses an import is tried when
    /// it is first needed after the import was handed over: in [`Executor::encode`], before the host's encoder is touched.)
    ///
    /// # Errors
    /// See [`ExecuteError`]; an error about a pass names it and its place.
    pub fn new(
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        plan: Plan,
        provider: &mut dyn Provider,
    ) -> Result<Self, ExecuteError> {
        alive(device)?;
        let refused = |error| with_table(error, &plan);
        let memory = Memory::new(&plan, None, device, queue, provider).map_err(refused)?;
        let mut pipelines = Pipelines::default();
        let passes = (0..plan.schedule.len())
            .map(|at| MadePass::new(&plan, at, None, &mut pipelines, device))
            .collect::<Result<Vec<_>, _>>()
            .map_err(refused)?;
        let contents = Contents::of(&plan, 0);
        let poison = Poison::new(&plan, &memory, device).map_err(refused)?;
        let mut executor = Self {
            poison,
            timer: Timer::new(device, queue)?,
            device: device.clone(),
            queue: queue.clone(),
            histories: contents.histories(&plan, &vec![true; passes.len()]),
            plan,
            memory,
            pipelines,
            passes,
            contents,
            timed: false,
            cpu: Vec::new(),
            skipped: Vec::new(),
            pending: Vec::new(),
        };
        executor.bind_what_can_be()?;
        Ok(executor)
    }

    /// The plan.
    pub fn plan(&self) -> &Plan {
        &self.plan
    }

    /// Hands over a texture that the plan was told of in [`PlanRequest::imports`](crate::PlanRequest::imports). Its content counts
    /// as changed.
    ///
    /// # Errors
    /// If the plan has no such import, the texture is not as described, or it is another one and the device is lost.
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
    /// If the plan has no such import, or the buffer is not as described.
    pub fn import_buffer(&mut self, name: &str, buffer: &wgpu::Buffer) -> Result<(), ExecuteError> {
        self.import(name, Physical::Buffer(buffer.clone()))
    }

    fn import(&mut self, name: &str, physical: Physical) -> Result<(), ExecuteError> {
        let Some(described) = self.plan.request.imports.get(name) else {
            let known: Vec<&str> = self
                .plan
                .request
                .imports
                .keys()
                .map(String::as_str)
                .collect();
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
        let Some(id) = self.live(name) else {
            self.memory.spare(name, physical);
            return Ok(());
        };
        // Most hosts hand over the same texture in every frame.
        if self.memory.host(id) != Some(&physical) {
            alive(&self.device)?;
        }
        self.contents.touch(id);
        if self.memory.import(id, physical) {
            self.unbind(id);
        }
        Ok(())
    }

    /// Tells that the content of an import or provided resource has changed, so that passes with `run: OnChange` that read it run
    /// in the next frame. (A provider that counts [`versions`](Provider::version) needs [`refresh`](Self::refresh) instead.)
    ///
    /// # Errors
    /// If the plan has nothing of the host's under this name. (One that no live pass uses is fine.)
    pub fn touch(&mut self, name: &str) -> Result<(), ExecuteError> {
        let of_host = |resource: &&Resource| resource.origin == Origin::Host;
        if let Some(id) = self.live(name)
            && self.plan.resources[id.0].origin == Origin::Host
        {
            self.contents.touch(id);
        } else if !self.plan.request.offers(name) {
            let used = self
                .plan
                .lifetimes
                .keys()
                .map(|id| &self.plan.resources[id.0]);
            let used: Vec<&str> = used
                .filter(of_host)
                .map(|resource| resource.name.as_str())
                .collect();
            return Err(ExecuteError::NotOfHost {
                name: name.to_owned(),
                known: list(&used),
            });
        }
        Ok(())
    }

    /// Asks the provider for every resource of another [version](Provider::version) than before.
    ///
    /// # Errors
    /// If one cannot be built, or is described otherwise than when the graph was planned (more items, say: that needs another
    /// plan, see [`replace_graph`](Self::replace_graph)), or the device is lost. The rest stays as it was and is asked for again the next time.
    pub fn refresh(&mut self, provider: &mut dyn Provider) -> Result<(), ExecuteError> {
        let known: Vec<(ResourceId, u64)> = self.memory.provided().collect();
        for (id, version) in known {
            let resource = &self.plan.resources[id.0];
            if provider.version(&resource.name) == version {
                continue;
            }
            alive(&self.device)?;
            let before = self.memory.host(id).cloned();
            self.memory
                .refresh(id, resource, None, &self.device, &self.queue, provider)?;
            self.contents.touch(id);
            if self.memory.host(id) != before.as_ref() {
                self.unbind(id);
            }
        }
        Ok(())
    }

    /// An output or capture as the last frame left it, for the host to bind. A resource with a history has another view in every
    /// frame, and [`resize`](Self::resize) and the like make new ones.
    pub fn output_view(&self, name: &str) -> Option<wgpu::TextureView> {
        let (_, target) = self.plan.readable.iter().find(|(known, _)| known == name)?;
        let dimension = match target.part.layers.len() {
            1 => wgpu::TextureViewDimension::D2,
            _ => wgpu::TextureViewDimension::D2Array,
        };
        self.memory.view(target, dimension, &self.histories).ok()
    }

    /// A buffer among the outputs and captures as the last frame left it.
    pub fn output_buffer(&self, name: &str) -> Option<wgpu::Buffer> {
        let (_, target) = self.plan.readable.iter().find(|(known, _)| known == name)?;
        self.memory.buffer(target.id, &self.histories).ok().cloned()
    }

    /// Encodes a frame. The host submits the encoder and then calls [`Executor::submitted`].
    ///
    /// # Errors
    /// If an output is asked for that the plan does not have, an import is missing, the device is lost or has no memory to read
    /// something back, or refuses a pass that is bound in this frame for the first time. Nothing has been encoded then.
    pub fn encode(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        frame: &Frame<'_>,
    ) -> Result<(), ExecuteError> {
        alive(&self.device)?;
        let runs = self.contents.running(&self.plan, &self.passes, frame.all);
        let histories = self.contents.histories(&self.plan, &runs);
        self.bind(&runs, &histories)?;
        let mut pending = Vec::new();
        for name in frame.read {
            // The staging buffer is made here, so there may be no memory for it.
            let made = scoped(&self.device, name, || {
                Pending::new(&self.device, &self.plan, &self.memory, &histories, name)
            });
            let made = made.map_err(|error| with_table(error, &self.plan))??;
            pending.push(made);
        }
        self.timed = frame.timing;
        if self.timed {
            self.timer.open(&self.device)?;
        }
        self.cpu.clear();
        self.skipped.clear();
        for (at, pass) in self.passes.iter().enumerate() {
            if !runs[at] {
                self.skipped.push(pass.name.clone());
                continue;
            }
            let start = frame.timing.then(Instant::now);
            if let Some(poison) = &self.poison {
                poison.fill(at, &histories, encoder);
            }
            let steps = pass.steps(&histories).unwrap_or_default();
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
        self.contents
            .ran(&self.plan, &mut self.passes, &runs, &histories);
        self.histories = histories;
        Ok(())
    }

    /// Ends the timing frame and starts the readbacks, after the host has submitted the encoder.
    ///
    /// # Errors
    /// If timestamps could not be taken.
    pub fn submitted(&mut self, _queue: &wgpu::Queue) -> Result<(), ExecuteError> {
        if self.timed {
            self.timer.submitted()?;
        }
        self.pending.iter_mut().for_each(Pending::map);
        Ok(())
    }

    /// Waits until the submitted frame is done and hands out its times and readbacks.
    ///
    /// # Errors
    /// If the device was lost.
    pub fn finish(&mut self) -> Result<FrameReport, ExecuteError> {
        self.finish_within(None)
    }

    /// [`finish`](Self::finish) that waits no longer than `timeout`, if there is one. A shader that never ends blocks some drivers
    /// for ever; others lose the device.
    ///
    /// # Errors
    /// Besides those of `finish`: [`ExecuteError::Unfinished`]. The frame can be waited for again. A host that gives up must know that wgpu waits,
    /// without end, when the last handle of the queue is dropped: `std::mem::forget` a clone of it to let the process end.
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
        // A device that was destroyed is waited for without complaint, but has no query buffers to take times from.
        alive(&self.device)?;
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
        let passes = self.passes.iter().map(|pass| &*pass.name);
        let ran = passes.filter(|name| self.skipped.iter().all(|skipped| **skipped != **name));
        ran.collect()
    }

    /// The resource of a name that a live pass uses.
    fn live(&self, name: &str) -> Option<ResourceId> {
        let mut live = self.plan.lifetimes.keys();
        live.find(|id| self.plan.resources[id.0].name == name)
            .copied()
    }

    /// Forgets what the passes that use a resource have bound.
    fn unbind(&mut self, id: ResourceId) {
        for (pass, made) in self.plan.schedule.iter().zip(&mut self.passes) {
            let mut accesses = self.plan.passes[*pass].accesses.iter();
            if accesses.any(|access| access.resource == id) {
                made.unbind();
            }
        }
    }

    /// Binds the passes that run and are not bound for this state of the histories.
    fn bind(&mut self, runs: &[bool], histories: &Histories) -> Result<(), ExecuteError> {
        for (at, made) in self.passes.iter_mut().enumerate() {
            if !runs[at] || made.is_bound(histories) {
                continue;
            }
            let pass = &self.plan.passes[self.plan.schedule[at]];
            if let Some(name) = missing_import(&self.plan, &self.memory, at) {
                return Err(ExecuteError::NotImported {
                    name,
                    pass: pass.name.value.clone(),
                    place: pass.name.span.to_string(),
                });
            }
            made.bind(pass, &self.memory, histories, &self.device)?;
        }
        Ok(())
    }

    /// Binds every pass whose imports are there, as a frame in which all run will need it.
    fn bind_what_can_be(&mut self) -> Result<(), ExecuteError> {
        let ready: Vec<bool> = (0..self.passes.len())
            .map(|at| missing_import(&self.plan, &self.memory, at).is_none())
            .collect();
        let histories = self
            .contents
            .histories(&self.plan, &vec![true; ready.len()]);
        self.bind(&ready, &histories)
    }
}

/// Names for a message.
fn list(names: &[&str]) -> String {
    match names.is_empty() {
        true => "none".to_owned(),
        false => names.join(", "),
    }
}

/// An import that a pass uses and the host has not handed over.
fn missing_import(plan: &Plan, memory: &Memory, at: usize) -> Option<String> {
    let mut accesses = plan.passes[plan.schedule[at]].accesses.iter();
    let missing = accesses.find(|access| {
        plan.resources[access.resource.0].origin == Origin::Host
            && memory.host(access.resource).is_none()
    })?;
    Some(plan.resources[missing.resource.0].name.clone())
}

impl std::fmt::Debug for Executor {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Executor")
            .field("plan", &self.plan)
            .finish_non_exhaustive()
    }
}
