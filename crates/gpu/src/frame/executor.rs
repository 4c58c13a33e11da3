//! Runs a plan on a device, frame by frame.

use super::growth_readback::GrowthReadback;
use super::in_flight::{list, names};
use super::prepare::{Prepared, Preparer};
use super::replan::ReplanReport;
use super::report::{Frame, FrameFault, FrameReport};
use super::runner::Runner;
use crate::device::Gpu;
use crate::error::{ExecuteError, poll, submit, wait};
use crate::memory::physical::Physical;
use crate::pipelines::pipelines::Pipelines;
use crate::provider::Provider;
use crate::waiting::submitted_work;
use skiagraph_graph::{Origin, ParamValue, Plan, Provided, Resource, ResourceKind};
use std::time::Duration;
use web_time::Instant;

/// Longest wait for another thread that polls the device to signal finished work.
const CALLBACK: Duration = Duration::from_secs(10);

/// Runs a [`Plan`] on a wgpu device: creates its resources and pipelines, and encodes its frames
/// into the host's command encoders.
///
/// For each frame call [`refresh`](Self::refresh) if the provider may have changed, and
/// [`encode`](Self::encode), then submit the encoder. If the [`Frame`] requests times, statistics
/// or readbacks, collect its report with [`poll`](Self::poll), which does not wait, in this frame
/// or a later one, or with [`finish`](Self::finish), which waits. Submit the encoders of all
/// frames, in the order of encoding: later frames use the results of earlier ones, in skipped
/// passes and as `.previous`.
///
/// A frame is *lost* if its encoder is dropped instead, or wgpu refuses its commands, in `finish`
/// or in `submit`. Each frame that is encoded after that is as if the lost one had never been
/// encoded, but for its number; so are `.previous` contents and materials with
/// [`keep`](Resource::keep). A frame that was encoded before, and runs without the lost one or in
/// another order than that of encoding, may show something stale; `.previous` contents and
/// materials with `keep` then go on from what the frames have left that ran.
/// [`take_faults`](Self::take_faults) tells the numbers of all these frames.
///
/// Terms: a pass is [*live*](skiagraph_graph#terms) if its results are needed. *Outputs* are the
/// results that the graph document lists, *captures* are further contents that
/// [`PlanRequest::captures`](skiagraph_graph::PlanRequest) names. *Imports* are textures, buffers
/// and samplers that the host sets; *provided resources* are buffers and acceleration structures
/// that a [`Provider`] builds. A material's `.previous` is its content at the end of the frame
/// before.
pub struct Executor {
    runner: Runner,
}

impl Executor {
    /// Creates an executor for a plan that was made for the limits and features of `device`
    /// ([`PlanRequest`](skiagraph_graph::PlanRequest)). It creates the plan's textures, buffers and
    /// pipelines and asks the provider for the resources that [live](skiagraph_graph#terms) passes
    /// bind. It encodes each of these passes once into a throw-away encoder, so that errors of the
    /// device are found here. A pass that uses an import (a resource that the host sets later), or
    /// a resource that the provider cannot build yet, is tried only in [`Executor::encode`], before
    /// the host's encoder is touched.
    ///
    /// Executors that this function makes on one device share their
    /// [pipelines](Pipelines::shared). If another executor of the same graph is there, this one
    /// compiles nothing.
    ///
    /// # Errors
    /// See [`ExecuteError`]; an error about a pass names the pass and its place in the graph
    /// document.
    pub fn new(
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        plan: Plan,
        provider: &mut dyn Provider,
    ) -> Result<Self, ExecuteError> {
        Self::with_pipelines(&Pipelines::shared(device), queue, plan, provider)
    }

    /// Creates an executor of a plan on an open device. Executors of one [`Gpu`] share its
    /// [pipelines](Gpu::pipelines).
    ///
    /// # Errors
    /// Those of [`new`](Self::new).
    pub fn on(gpu: &Gpu, plan: Plan, provider: &mut dyn Provider) -> Result<Self, ExecuteError> {
        Self::with_pipelines(&gpu.pipelines, &gpu.queue, plan, provider)
    }

    /// Creates an executor as [`new`](Self::new) does, on the device of `pipelines`, which it
    /// shares: it makes only the shader modules and pipelines that are missing there. `queue` is
    /// the queue of that device.
    ///
    /// # Errors
    /// Those of [`new`](Self::new), of which [`ExecuteError::OtherDevice`] names a queue or a
    /// provider of another device.
    pub fn with_pipelines(
        pipelines: &Pipelines,
        queue: &wgpu::Queue,
        plan: Plan,
        provider: &mut dyn Provider,
    ) -> Result<Self, ExecuteError> {
        let runner = Runner::new(pipelines, queue, plan, provider)?;
        Ok(Self { runner })
    }

    /// Returns the plan that the executor runs now, after the last change of viewport, param or
    /// graph.
    pub fn plan(&self) -> &Plan {
        &self.runner.state.plan
    }

    /// Returns the shader modules and pipelines of the executor, which others can
    /// [share](Self::with_pipelines).
    pub fn pipelines(&self) -> &Pipelines {
        &self.runner.pipelines
    }

    /// Returns the name of the first pass that works on the CPU
    /// ([`CpuWork`](crate::CpuWork)), for which [`submit`](Self::submit) waits within a frame.
    /// `None` if all passes run on the GPU.
    pub fn waits_in(&self) -> Option<&str> {
        Some(&self.runner.state.on_cpu()?.name.value)
    }

    /// Encodes the passes of a frame into `encoder`, which the host then submits, and returns the
    /// frame's number, counted from 0 and never given twice. It never waits; any number of frames
    /// may be in flight. Several may be encoded before the first is submitted, with changes of
    /// params, plan, imports and provider between them: each keeps the resources and values that it
    /// was encoded with. Changes of the provider are seen from the next [`refresh`](Self::refresh)
    /// on. Submit the frames in the order of encoding. Textures and buffers that the graph document
    /// declares with [`grow`](skiagraph_graph::Growth) and that proved too small for an earlier,
    /// submitted frame are larger from this frame on (see [`Plan::grown`]), and their views are
    /// others ([`output_view`](Self::output_view)).
    ///
    /// If nothing has changed since a frame that the GPU is done with, no pass is encoded: the
    /// outputs of that frame are still there. This needs a provider that
    /// [has versions](Provider::has_versions), or a plan without provided resources; imports whose
    /// [versions](Self::set_import_version) the host tells, or none; and a plan in which no pass
    /// writes to an import, uses `.previous` contents, a resource with [`keep`](Resource::keep) or
    /// the uniform [`frame`](skiagraph_graph::FRAME_BYTES). Frames with [`Frame::all`],
    /// [`Frame::timing`] or [`Frame::statistics`] are never left out so.
    ///
    /// While a frame before is not known to be done, `encode` polls the device, without waiting.
    ///
    /// # Errors
    /// If the plan lacks an output or capture of [`Frame::read`] or it cannot be copied; an import
    /// or a provided resource of a pass that runs is missing; the device is lost, has too little
    /// memory, or refuses a pass that is bound for the first time; a pass works on the CPU, for
    /// which there is [`submit`](Self::submit). After an error nothing has been encoded.
    pub fn encode(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        frame: &Frame<'_>,
    ) -> Result<u32, ExecuteError> {
        if let Some(pass) = self.runner.state.on_cpu() {
            return Err(ExecuteError::OnCpu {
                pass: pass.name.value.clone(),
                place: pass.name.span.to_string(),
            });
        }
        self.runner.encode_with(encoder, frame, None)
    }

    /// Encodes a frame as [`encode`](Self::encode) does, and submits it. Where a pass works on the
    /// CPU ([`CpuWork`](crate::CpuWork)) it submits what is encoded so far, waits until the GPU is
    /// done with that, and then until the work is done. While the GPU works, `gives_up` is called
    /// about every 100 ms; if it returns true, the frame ends. `submit` waits for nothing else,
    /// such as the end of the frame on the GPU.
    ///
    /// # Errors
    /// Those of `encode`, except that passes may work on the CPU; [`ExecuteError::CpuWork`] if
    /// their work fails, [`ExecuteError::Unfinished`] if `gives_up` has ended the frame,
    /// [`ExecuteError::Refused`] if wgpu refuses the frame's commands. A frame that failed has no
    /// report and does not count: the next one runs its passes again, from the same `.previous`
    /// contents. After `Unfinished` the GPU may never finish.
    pub fn submit(
        &mut self,
        frame: &Frame<'_>,
        gives_up: &dyn Fn() -> bool,
    ) -> Result<u32, ExecuteError> {
        let label = Some("frame");
        let begun = wgpu::CommandEncoderDescriptor { label };
        let runner = &mut self.runner;
        let mut encoder = runner.device.create_command_encoder(&begun);
        let index = runner.encode_with(&mut encoder, frame, Some(gives_up))?;
        submit((&runner.device, &runner.queue), encoder, index).map(|()| index)
    }

    /// Returns the report of the oldest frame that requested times, statistics or readbacks (fields
    /// of [`Frame`]) and has not been reported yet. `None` if the GPU has not finished that frame,
    /// or if no such frame is left. It never waits. Each frame with a request brings one report, in
    /// the order of encoding; lost frames (see [`Executor`]) bring none.
    ///
    /// # Errors
    /// If the device was lost, or a readback or the times of the frame failed. The failed frame
    /// brings no report.
    pub fn poll(&mut self) -> Result<Option<FrameReport>, ExecuteError> {
        self.runner.poll()
    }

    /// Returns the frames that did not show what they should, in the order in which that was found,
    /// and forgets them. It never waits: a frame that is not done yet is told by a later call. At
    /// most 1,024 frames are kept for it, those found last.
    ///
    /// A frame is lost if its encoder is dropped, or if wgpu refuses its commands, in `finish` or
    /// in `submit`. What was encoded before this was known and runs without it, or in another
    /// order than that of encoding, may show something stale, and is told, too. Every frame that is
    /// encoded afterwards is right; see [`Executor`]. A frame that had nothing to run
    /// ([`encode`](Self::encode)) and asked for nothing is never told.
    ///
    /// # Errors
    /// If the device was lost.
    pub fn take_faults(&mut self) -> Result<Vec<FrameFault>, ExecuteError> {
        self.runner.presence.check()?;
        if self.runner.frames_in_flight.is_pending() {
            self.runner.settle()?;
        }
        Ok(std::mem::take(&mut self.runner.frames_in_flight.faults))
    }

    /// Returns the number of encoded frames that requested times, statistics or readbacks (fields
    /// of [`Frame`]) and have not been reported yet. It grows without bound if a host makes a
    /// request in every frame but does not call [`poll`](Self::poll). Frames that are known to be
    /// lost do not count.
    pub fn under_way(&self) -> usize {
        self.runner.frames_in_flight.asked()
    }

    /// Returns the report that [`poll`](Self::poll) would; if there is none yet, first waits until
    /// the GPU has finished all submitted work. If no frame waits for its report, `finish` returns
    /// a report of the last encoded frame that holds only the frame's number and its skipped
    /// passes; the number is `u32::MAX` if no frame was encoded.
    ///
    /// # Errors
    /// Those of [`poll`](Self::poll), and [`ExecuteError::NotRun`] if the frame to report is lost
    /// and no other has a report, or, after ten seconds, if it was not submitted.
    pub fn finish(&mut self) -> Result<FrameReport, ExecuteError> {
        self.finish_within(None)
    }

    /// Waits as [`finish`](Self::finish) does, but no longer than `timeout`; `None` sets no limit.
    /// A shader that never ends blocks some drivers for ever; others lose the device.
    ///
    /// # Errors
    /// Those of `finish`, and [`ExecuteError::Unfinished`] after the timeout; the frame can be
    /// waited for again. A host that gives up should `std::mem::forget` a clone of the queue before
    /// it exits: wgpu waits without end when the last handle of the queue is dropped.
    pub fn finish_within(
        &mut self,
        timeout: Option<Duration>,
    ) -> Result<FrameReport, ExecuteError> {
        let began = Instant::now();
        let waited_for = self.runner.frames_in_flight.oldest_asked();
        if !self.is_told()? {
            return Err(self.unfinished(began));
        }
        // One that is done is not kept waiting by those behind it.
        if let Some(report) = self.poll()? {
            return Ok(report);
        }
        if !wait(&self.runner.device, timeout)? {
            return Err(self.unfinished(began));
        }
        // A device that was destroyed is waited for without complaint, but has no query buffers to
        // take times from.
        self.runner.presence.check()?;
        let waited = Instant::now();
        loop {
            self.runner.settle()?;
            if let Some(report) = self.runner.report()? {
                return Ok(report);
            }
            if self.under_way() == 0 {
                if let Some(frame) = waited_for {
                    return Err(ExecuteError::NotRun { frame });
                }
                return Ok(FrameReport {
                    index: self.runner.frames.wrapping_sub(1),
                    skipped: names(&self.runner.skipped),
                    ..FrameReport::default()
                });
            }
            if timeout.is_some_and(|timeout| began.elapsed() >= timeout) {
                return Err(self.unfinished(began));
            }
            if waited.elapsed() >= CALLBACK {
                break;
            }
            if cfg!(target_arch = "wasm32") {
                return Err(self.unfinished(began));
            }
            // Another thread that polls the device may be about to say so.
            std::thread::sleep(Duration::from_micros(50));
        }
        // The profiler never gives up a frame whose timestamps cannot be mapped.
        self.runner.frames_in_flight.give_up();
        let frame = waited_for.unwrap_or_default();
        self.runner.report()?.ok_or(ExecuteError::NotRun { frame })
    }

    /// Waits as [`finish`](Self::finish) does, but leaves the thread to others meanwhile.
    /// [`block_on`](crate::block_on) drives it on this thread; in a browser, where no thread can
    /// wait, the event loop does.
    ///
    /// # Errors
    /// Those of `finish`.
    pub async fn finished(&mut self) -> Result<FrameReport, ExecuteError> {
        let mut patience = Duration::ZERO;
        loop {
            match self.finish_within(Some(patience)) {
                Err(ExecuteError::Unfinished { .. }) => (),
                done => return done,
            }
            submitted_work(&self.runner.device, &self.runner.queue).await;
            // The report of a frame that is done may come a moment after it.
            patience = Duration::from_millis(1);
        }
    }

    /// True if it is known of all frames whether they ran, of growing buffers how much they need,
    /// and of what was made whether the device took it. Outside of a browser a wait is enough.
    #[cfg(target_arch = "wasm32")]
    fn is_told(&mut self) -> Result<bool, ExecuteError> {
        self.runner.settle()?;
        let mut counters = self.runner.state.growth_readbacks.iter();
        let is_counted = !counters.any(GrowthReadback::is_under_way);
        Ok(crate::late::is_told() && is_counted && !self.runner.frames_in_flight.is_pending())
    }

    #[cfg(not(target_arch = "wasm32"))]
    fn is_told(&self) -> Result<bool, ExecuteError> {
        Ok(true)
    }

    /// Returns the error of a frame that has not finished, with the passes of the last frame.
    fn unfinished(&self, began: Instant) -> ExecuteError {
        let skipped = &self.runner.skipped;
        let passes = self.runner.state.passes.iter().map(|pass| &*pass.name);
        let ran = passes.filter(|name| skipped.iter().all(|skipped| **skipped != **name));
        ExecuteError::Unfinished {
            after: began.elapsed(),
            passes: list(ran),
        }
    }

    /// Sets the texture of the import `name`, which
    /// [`PlanRequest::imports`](skiagraph_graph::PlanRequest::imports) describes. Its content
    /// counts as changed, even if the texture is the one set before, unless the host tells its
    /// [version](Self::set_import_version): passes that run only when an input has changed (`run:
    /// OnChange` in the document) and read it run in the next frame. The texture may have more
    /// usages than described.
    ///
    /// # Errors
    /// [`ExecuteError::NoSuchImport`] if the plan has no import of this name,
    /// [`ExecuteError::Import`] if the texture differs from its description,
    /// [`ExecuteError::OtherDevice`] if it is of another device, [`ExecuteError::DeviceLost`] if
    /// the device is lost.
    pub fn import_texture(
        &mut self,
        name: &str,
        texture: &wgpu::Texture,
    ) -> Result<(), ExecuteError> {
        self.import(name, Physical::Texture(texture.clone()))
    }

    /// Sets the buffer of the import `name`, which
    /// [`PlanRequest::imports`](skiagraph_graph::PlanRequest::imports) describes. Its content
    /// counts as changed, even if the buffer is the one set before, unless the host tells its
    /// [version](Self::set_import_version): passes with `run: OnChange` that read it run in the
    /// next frame. The buffer may have more usages than described.
    ///
    /// # Errors
    /// Those of [`import_texture`](Self::import_texture).
    pub fn import_buffer(&mut self, name: &str, buffer: &wgpu::Buffer) -> Result<(), ExecuteError> {
        self.import(name, Physical::Buffer(buffer.clone()))
    }

    /// Sets the sampler of the import `name`, which
    /// [`PlanRequest::imports`](skiagraph_graph::PlanRequest::imports) describes. Passes with `run:
    /// OnChange` that use it run in the next frame if it is not the one set before. wgpu tells
    /// neither how a sampler filters nor which device it is of, so a wrong one is refused only when
    /// a pass binds it.
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

    /// Tells which version the content of the import `name` has: a number that is larger whenever
    /// the host has written into the texture or buffer. From then on only another version, another
    /// texture or buffer, and [`touch`](Self::touch) count as a change; so a host whose camera and
    /// scene stand still may hand over its depth in every frame, and no pass runs (see
    /// [`encode`](Self::encode)). What is written without a new version is not seen.
    ///
    /// # Errors
    /// [`ExecuteError::NoSuchImport`] if the plan has no import of this name.
    /// [`ExecuteError::ImportVersion`] if the version is lower than the one before. The executor
    /// takes it over all the same, and the content counts as changed.
    pub fn set_import_version(&mut self, name: &str, version: u64) -> Result<(), ExecuteError> {
        let Runner { imports, state, .. } = &mut self.runner;
        imports.set_version(name, version, state)
    }

    fn import(&mut self, name: &str, physical: Physical) -> Result<(), ExecuteError> {
        let runner = &mut self.runner;
        let on = (&runner.device, &runner.presence);
        runner.imports.set(name, physical, &mut runner.state, on)
    }

    /// Marks the content of the import or provided resource `name` as changed, after the host has
    /// written to it. In the next frame, passes with `run: OnChange` (which run only when an input
    /// has changed) that read it run, and those with `run: Always` also where the frame would
    /// otherwise compute nothing new (see [`encode`](Self::encode)); the frame after that finds
    /// this content as `.previous` (content of the frame before). With a provider that counts
    /// [`versions`](Provider::version), call [`refresh`](Self::refresh) instead.
    ///
    /// # Errors
    /// [`ExecuteError::NotOfHost`] if the plan has neither an import nor a provided resource of
    /// this name. A name that no pass uses is accepted.
    pub fn touch(&mut self, name: &str) -> Result<(), ExecuteError> {
        let of_host = |resource: &Resource| resource.origin == Origin::Host;
        if !self.plan().imports().contains_key(name) {
            self.runner.host_changes.changed.note(name);
        }
        let live = self.runner.state.live(name);
        if let Some(id) = live.filter(|id| of_host(self.plan().resource(*id))) {
            self.runner.state.touch(id);
        } else if !self.plan().offers(name) {
            let used = self.plan().used().filter(|used| of_host(used));
            return Err(ExecuteError::NotOfHost {
                name: name.to_owned(),
                known: list(used.map(|resource| resource.name.as_str())),
            });
        }
        Ok(())
    }

    /// Asks the provider again for each resource whose [version](Provider::version) has changed
    /// since the executor last got it, and for each that was [missing](Provider::missing) then.
    /// Call it before [`encode`](Self::encode) when the provider may have changed. Frames that are
    /// already encoded keep their resources. Where resources have other numbers of items than the
    /// graph was planned for, it is planned for these, as [`replace_graph`](Self::replace_graph)
    /// does: pipelines and textures that stay the same are kept.
    ///
    /// # Errors
    /// If a resource cannot be built or its description differs from the one that the graph was
    /// planned for ([`ExecuteError::OtherThanPlanned`], for example in the kind of light, or in
    /// having no items, as a scene without masks), the graph cannot be planned for other numbers of
    /// items, the provider's resources are on another device
    /// ([`ExecuteError::OtherDevice`]), or the device is lost. That resource and those after it
    /// stay as they are; the next call asks for them again. [`Plan::relies_on`] lists resources
    /// whose description counts although no live pass binds them: if one of them differs, all stay
    /// as they are. The way out is another plan: [`Plan::with`], with the provider set, and
    /// [`replace_graph`](Self::replace_graph).
    pub fn refresh(&mut self, provider: &mut dyn Provider) -> Result<(), ExecuteError> {
        let refreshed = self.runner.refresh(provider);
        if !refreshed.as_ref().is_err_and(is_of_numbers) {
            return refreshed;
        }
        let plan = self.plan().with(|request| request.provider = &*provider)?;
        self.replace_graph(plan, provider).map(drop)
    }

    /// Returns a view of the output or capture `name` (see [`Executor`]) with the content of the
    /// last encoded frame, for the host to bind: outputs and captures have the usages
    /// `TEXTURE_BINDING` and `COPY_SRC`. It covers the mips and layers that belong to the output;
    /// its dimension is `D3` for a 3D texture, `D2` for a single layer, `D2Array` for several.
    /// `None` if no texture is an output or capture of this name, or it is an import that is not
    /// set. Fetch the view anew after [`resize`](Self::resize) or another change of the plan, and
    /// in every frame if a pass also reads the resource as `.previous` (content of the frame
    /// before), or if it may grow (`grow`): [`encode`](Self::encode) may then replace it. Only read
    /// it: a frame in which nothing has changed leaves it as it is.
    pub fn output_view(&self, name: &str) -> Option<wgpu::TextureView> {
        let target = self.plan().readable_target(name)?;
        let dimension = match &self.plan().resource(target.id).kind {
            ResourceKind::Texture(texture) if texture.is_3d => wgpu::TextureViewDimension::D3,
            _ if target.part.layers.len() == 1 => wgpu::TextureViewDimension::D2,
            _ => wgpu::TextureViewDimension::D2Array,
        };
        self.runner.in_frame().view(target, dimension).ok()
    }

    /// Returns the buffer of the output or capture `name` (see [`Executor`]) with the content of
    /// the last encoded frame; the whole buffer, even if only some of its items belong to the
    /// output. `None` if no buffer is an output or capture of this name, or it is an import that is
    /// not set. Fetch it anew when [`output_view`](Self::output_view) says so, and only read it.
    pub fn output_buffer(&self, name: &str) -> Option<wgpu::Buffer> {
        let target = self.plan().readable_target(name)?;
        let memory = &self.runner.state.memory;
        let buffer = memory.buffer(target.id, &self.runner.ping_pong);
        buffer.ok().cloned()
    }

    /// Changes the viewport to a width and height in pixels and plans the graph again. Textures
    /// whose size follows the viewport are recreated: their contents are lost, contents read as
    /// `.previous` (from the frame before) are zero, and the passes that write them run again.
    /// Imports stay as they are described: if their sizes follow the viewport, change both with
    /// [`Plan::with`] and [`replace_graph`](Self::replace_graph) instead.
    ///
    /// # Errors
    /// If the graph cannot be planned for this viewport, a provided resource cannot be built or is
    /// [no longer as planned](ExecuteError::OtherThanPlanned), or the device refuses a resource or
    /// pass. After an error the executor is unchanged.
    pub fn resize(
        &mut self,
        viewport: [u32; 2],
        provider: &mut dyn Provider,
    ) -> Result<ReplanReport, ExecuteError> {
        let plan = self.plan().with_viewport(viewport)?;
        self.replace_graph(plan, provider)
    }

    /// Changes the value of the param `name` of the graph document that was loaded, which may be
    /// one that the document exposes of an include, such as `left.radius`. If shaders read the
    /// param only in `var<uniform> params`, and it is not a
    /// [`Choice`](skiagraph_graph::ParamType::Choice), the change costs an upload. For every other
    /// param the graph is planned again, and the cost depends on the param's use:
    ///
    /// - an `override` constant, a culling mode, a depth bias or the like: new pipelines for the
    ///   passes that use it;
    /// - a size, a count, a `repeat` or an `if`: new resources and passes, including those that
    ///   depend on them;
    /// - a condition of `run: When(…)`: nothing more.
    ///
    /// # Errors
    /// If the graph has no such param, its value is out of range, the graph cannot be planned with
    /// it, a changed provided resource cannot be built or is [no longer as
    /// planned](ExecuteError::OtherThanPlanned), or the device refuses a resource or pass. After an
    /// error the plan and its params are unchanged.
    pub fn set_param(
        &mut self,
        name: &str,
        value: ParamValue,
        provider: &mut dyn Provider,
    ) -> Result<ReplanReport, ExecuteError> {
        if self.plan().is_in_uniforms(name, &value) {
            return self.runner.set_in_uniforms(name, value, provider);
        }
        let plan = self.plan().with_param(name, value)?;
        self.replace_graph(plan, provider)
    }

    /// Replaces the plan by another, of the same graph or of a different one. It keeps the
    /// pipelines, textures and buffers that both plans have in common (matched by name), the
    /// imports whose description is unchanged, and the provided resources whose version is
    /// unchanged.
    ///
    /// # Errors
    /// If a provided resource cannot be built or is not [as this plan was made
    /// for](ExecuteError::OtherThanPlanned), or the device refuses a resource or pass. After an
    /// error the executor is unchanged.
    pub fn replace_graph(
        &mut self,
        plan: Plan,
        provider: &mut dyn Provider,
    ) -> Result<ReplanReport, ExecuteError> {
        let report = self.runner.put_in(plan, provider)?;
        self.runner.note_changes(provider);
        Ok(report)
    }

    /// Returns a [`Preparer`], which can create the pipelines of the next plan on another thread
    /// ([`Preparer::prepare`]) while this executor draws.
    pub fn preparer(&self) -> Preparer {
        Preparer {
            pipelines: self.runner.pipelines.clone(),
        }
    }

    /// Replaces the plan, as [`replace_graph`](Self::replace_graph) does, by one whose pipelines a
    /// [`Preparer`] has created. Pipelines that are still missing are created now.
    ///
    /// # Errors
    /// Those of [`replace_graph`](Self::replace_graph). After an error the executor's plan is
    /// unchanged.
    pub fn replace(
        &mut self,
        prepared: Prepared,
        provider: &mut dyn Provider,
    ) -> Result<ReplanReport, ExecuteError> {
        let Prepared {
            plan,
            pipelines: _kept,
        } = prepared;
        self.replace_graph(plan, provider)
    }

    /// Enlarges the buffers and textures declared with `grow` that were too small for a finished
    /// frame. Shaders count in a buffer how many items or layers each of them needs. The content of
    /// a resource that grows is lost unless it has `keep` (see
    /// [`Growth`](skiagraph_graph::Growth)). [`encode`](Self::encode) enlarges them by itself; call
    /// `grow` to choose the time or to get the report. `None` if no resource had to grow, or the
    /// larger size was refused. It never waits: a count that the GPU has not delivered yet is read
    /// by a later call.
    ///
    /// If the memory limit or the device refuses a larger size, the resources keep their size, and
    /// growth stops until the plan is changed. Items that do not fit are then handled as the graph
    /// document says.
    ///
    /// # Errors
    /// If the device was lost, or a changed provided resource cannot be built or is [no longer as
    /// planned](ExecuteError::OtherThanPlanned). After an error the executor is unchanged, and the
    /// next frame tries to grow again.
    pub fn grow(
        &mut self,
        provider: &mut dyn Provider,
    ) -> Result<Option<ReplanReport>, ExecuteError> {
        self.runner.presence.check()?;
        let mut readbacks = self.runner.state.growth_readbacks.iter();
        if !readbacks.any(GrowthReadback::is_asked) {
            return Ok(None);
        }
        poll(&self.runner.device, wgpu::PollType::Poll)?;
        let Some(plan) = self.runner.larger() else {
            return Ok(None);
        };
        let report = self.runner.grow_to(plan, provider)?;
        if report.is_some() {
            self.runner.note_changes(provider);
        }
        Ok(report)
    }
}

/// True if a resource has another number of items than planned, and nothing else is other.
fn is_of_numbers(error: &ExecuteError) -> bool {
    let ExecuteError::OtherThanPlanned { planned, given, .. } = error else {
        return false;
    };
    let (Some(planned), Some(given)) = (planned, given) else {
        return false;
    };
    let has_items = |provided: &Provided| provided.items.is_some_and(|items| items > 0);
    let mut counted = *given;
    counted.items = planned.items;
    has_items(planned) && has_items(given) && *planned == counted
}

impl std::fmt::Debug for Executor {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Executor")
            .field("plan", self.plan())
            .finish_non_exhaustive()
    }
}
