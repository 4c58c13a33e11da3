//! Phase 10: the passes are encoded into the host's encoder; timing and readback end after submission.

use crate::{
    allocate::{MadeCall, MadeDraw, MadeGroups, MadeStep, Maker},
    memory::Memory,
    plan::Plan,
    provider::Provider,
    readback::{self, Pending, Readback},
    timing::{FrameTiming, Timer},
};
use std::time::{Duration, Instant};

/// Why a plan could not be allocated or a frame not be run.
#[derive(Clone, Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ExecuteError {
    /// wgpu refused something that a pass needs.
    #[error("{place}: pass `{pass}` was refused by the device: {message}")]
    Gpu {
        /// The pass.
        pass: String,
        /// Its place in the document.
        place: String,
        /// wgpu's words.
        message: String,
    },
    /// wgpu refused to make a resource.
    #[error("`{name}` could not be made: {message}")]
    Resource {
        /// The resource.
        name: String,
        /// wgpu's words.
        message: String,
    },
    /// The device has no memory for this.
    #[error("the device has not enough memory for `{name}`")]
    OutOfMemory {
        /// The resource or pass.
        name: String,
    },
    /// A provided resource could not be built.
    #[error("the provided resource `{name}` could not be built: {why}")]
    Provider {
        /// The resource.
        name: String,
        /// The provider's words.
        why: String,
    },
    /// A readback that the plan does not know.
    #[error("the plan has no output `{name}`; it has {known}")]
    NoSuchOutput {
        /// The name.
        name: String,
        /// What there is.
        known: String,
    },
    /// A readback did not arrive.
    #[error("the content of `{name}` could not be read back")]
    Readback {
        /// The output.
        name: String,
    },
    /// The device was lost or did not answer.
    #[error("the device was lost: {0}")]
    DeviceLost(String),
    /// Timestamps could not be taken.
    #[error("timestamps could not be taken: {0}")]
    Timing(String),
    /// A mistake of this crate.
    #[error("internal error: {0}")]
    Internal(&'static str),
}

/// What a frame is asked for.
#[derive(Clone, Copy, Debug, Default)]
pub struct Frame<'a> {
    /// Take GPU timestamps.
    pub timing: bool,
    /// Outputs and captures to read back.
    pub read: &'a [&'a str],
}

/// What a frame brought.
#[derive(Clone, Debug, Default)]
pub struct FrameReport {
    /// Times, if they were asked for.
    pub timing: Option<FrameTiming>,
    /// Contents, in the order in which they were asked for.
    pub readbacks: Vec<Readback>,
}

/// A plan on a device.
pub struct Executor {
    device: wgpu::Device,
    plan: Plan,
    memory: Memory,
    /// The steps of each scheduled pass.
    passes: Vec<(String, Vec<MadeStep>)>,
    timer: Timer,
    timed: bool,
    cpu: Vec<(String, Duration)>,
    pending: Vec<Pending>,
}

impl Executor {
    /// Makes what the plan needs on the device, asks the provider for what live passes bind, and encodes every pass once
    /// into a throw-away encoder, so that whatever the device refuses is refused here.
    ///
    /// # Errors
    /// See [`ExecuteError`]; an error about a pass names it and its place.
    pub fn new(
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        plan: Plan,
        provider: &mut dyn Provider,
    ) -> Result<Self, ExecuteError> {
        let memory = Memory::new(&plan, device, queue, provider)?;
        let mut passes = Vec::new();
        {
            let mut maker = Maker::new(device, &memory);
            for &index in &plan.schedule {
                let pass = &plan.passes[index];
                let refused = |error| named(error, &pass.name, &pass.name.span.to_string());
                let steps = scoped(device, &pass.name, || {
                    pass.steps
                        .iter()
                        .map(|step| maker.step(&pass.name, step))
                        .collect::<Result<Vec<_>, _>>()
                })
                .map_err(refused)??;
                scoped(device, &pass.name, || {
                    let mut encoder =
                        device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
                    steps
                        .iter()
                        .for_each(|step| encode(step, &pass.name, &mut encoder, None));
                    encoder.finish()
                })
                .map_err(refused)?;
                passes.push((pass.name.value.clone(), steps));
            }
        }
        let timer = Timer::new(device, queue)?;
        Ok(Self {
            device: device.clone(),
            plan,
            memory,
            passes,
            timer,
            timed: false,
            cpu: Vec::new(),
            pending: Vec::new(),
        })
    }

    /// The plan.
    pub fn plan(&self) -> &Plan {
        &self.plan
    }

    /// Encodes a frame. The host submits the encoder and then calls [`Executor::submitted`].
    ///
    /// # Errors
    /// If an output is asked for that the plan does not have (nothing has been encoded then), or there is no memory to read
    /// one back.
    pub fn encode(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        frame: &Frame<'_>,
    ) -> Result<(), ExecuteError> {
        let readable = &self.plan.readable;
        if let Some(name) = frame
            .read
            .iter()
            .find(|name| readable.iter().all(|(known, _)| known != *name))
        {
            let known: Vec<&str> = readable.iter().map(|(name, _)| name.as_str()).collect();
            return Err(ExecuteError::NoSuchOutput {
                name: (*name).to_owned(),
                known: known.join(", "),
            });
        }
        self.timed = frame.timing;
        self.cpu.clear();
        for (name, steps) in &self.passes {
            let start = Instant::now();
            encoder.push_debug_group(name);
            steps
                .iter()
                .for_each(|step| encode(step, name, encoder, frame.timing.then_some(&self.timer)));
            encoder.pop_debug_group();
            self.cpu.push((name.clone(), start.elapsed()));
        }
        if frame.timing {
            self.timer.resolve(encoder);
        }
        self.pending.clear();
        for name in frame.read {
            // The staging buffer is made here, so there may be no memory for it.
            let pending = scoped(&self.device, name, || {
                readback::copy(&self.device, encoder, &self.plan, &self.memory, name)
            })??;
            self.pending.push(pending);
        }
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
        self.device
            .poll(wgpu::PollType::wait_indefinitely())
            .map_err(|error| ExecuteError::DeviceLost(error.to_string()))?;
        let timing = self.timed.then(|| self.timer.take(&self.cpu));
        let readbacks = std::mem::take(&mut self.pending)
            .into_iter()
            .map(Pending::take)
            .collect::<Result<_, _>>()?;
        Ok(FrameReport { timing, readbacks })
    }
}

impl std::fmt::Debug for Executor {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Executor")
            .field("plan", &self.plan)
            .finish_non_exhaustive()
    }
}

/// Runs `make` inside error scopes, so that what wgpu finds wrong comes back as an error.
pub(crate) fn scoped<T>(
    device: &wgpu::Device,
    name: &str,
    make: impl FnOnce() -> T,
) -> Result<T, ExecuteError> {
    let scopes = [
        wgpu::ErrorFilter::OutOfMemory,
        wgpu::ErrorFilter::Internal,
        wgpu::ErrorFilter::Validation,
    ]
    .map(|filter| device.push_error_scope(filter));
    let made = make();
    // Scopes are a stack: the last one pushed is popped first.
    let errors: Vec<wgpu::Error> = scopes
        .into_iter()
        .rev()
        .filter_map(|scope| pollster::block_on(scope.pop()))
        .collect();
    match errors.into_iter().next() {
        None => Ok(made),
        Some(wgpu::Error::OutOfMemory { .. }) => Err(ExecuteError::OutOfMemory {
            name: name.to_owned(),
        }),
        Some(error) => Err(ExecuteError::Resource {
            name: name.to_owned(),
            message: chain(&error),
        }),
    }
}

fn chain(error: &wgpu::Error) -> String {
    match error {
        wgpu::Error::Validation { description, .. } | wgpu::Error::Internal { description, .. } => {
            description.trim().to_owned()
        }
        wgpu::Error::OutOfMemory { .. } => "out of memory".to_owned(),
    }
}

fn named(error: ExecuteError, pass: &str, place: &str) -> ExecuteError {
    match error {
        ExecuteError::Resource { message, .. } => ExecuteError::Gpu {
            pass: pass.to_owned(),
            place: place.to_owned(),
            message,
        },
        other => other,
    }
}

fn encode(step: &MadeStep, name: &str, encoder: &mut wgpu::CommandEncoder, timer: Option<&Timer>) {
    match step {
        MadeStep::Draw(draw) => encode_draw(draw, name, encoder, timer),
        MadeStep::Dispatch {
            pipeline,
            groups,
            size,
        } => {
            let query = timer.map(|timer| timer.profiler().begin_pass_query(name, encoder));
            {
                let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
                    label: Some(name),
                    timestamp_writes: query
                        .as_ref()
                        .and_then(|query| query.compute_pass_timestamp_writes()),
                });
                if let Some(timer) = timer {
                    timer.open_compute(&mut pass);
                }
                pass.set_pipeline(pipeline);
                for (index, group) in (0u32..).zip(groups) {
                    pass.set_bind_group(index, group.as_ref(), &[]);
                }
                match size {
                    MadeGroups::Fixed([x, y, z]) => pass.dispatch_workgroups(*x, *y, *z),
                    MadeGroups::Indirect(buffer) => pass.dispatch_workgroups_indirect(buffer, 0),
                }
            }
            end(timer, query, encoder);
        }
        MadeStep::CopyTexture {
            from,
            to,
            origins,
            mips,
        } => {
            let query = timer.map(|timer| timer.profiler().begin_query(name, encoder));
            let place = |texture, index: usize, mip: u32| wgpu::TexelCopyTextureInfo {
                texture,
                mip_level: origins[index].part.mips.start + mip,
                origin: wgpu::Origin3d {
                    x: 0,
                    y: 0,
                    z: origins[index].part.layers.start,
                },
                aspect: wgpu::TextureAspect::All,
            };
            for (mip, extent) in (0u32..).zip(mips) {
                encoder.copy_texture_to_texture(place(from, 0, mip), place(to, 1, mip), *extent);
            }
            end(timer, query, encoder);
        }
        MadeStep::CopyBuffer { from, to } => {
            let query = timer.map(|timer| timer.profiler().begin_query(name, encoder));
            encoder.copy_buffer_to_buffer(from, 0, to, 0, from.size().min(to.size()));
            end(timer, query, encoder);
        }
        MadeStep::ClearBuffer(buffer) => {
            let query = timer.map(|timer| timer.profiler().begin_query(name, encoder));
            encoder.clear_buffer(buffer, 0, None);
            end(timer, query, encoder);
        }
        MadeStep::ClearTexture {
            views,
            depth,
            value,
        } => {
            for view in views {
                let query = timer.map(|timer| timer.profiler().begin_pass_query(name, encoder));
                let color = (!depth).then(|| color_attachment(view, Some(*value)));
                #[expect(clippy::cast_possible_truncation, reason = "a depth is f32")]
                let depth = depth.then(|| depth_attachment(view, Some(value[0] as f32), true));
                render_pass(name, encoder, color.as_slice(), depth, query.as_ref());
                end(timer, query, encoder);
            }
        }
    }
}

fn end(
    timer: Option<&Timer>,
    query: Option<wgpu_profiler::GpuProfilerQuery>,
    encoder: &mut wgpu::CommandEncoder,
) {
    if let (Some(timer), Some(query)) = (timer, query) {
        timer.profiler().end_query(encoder, query);
    }
}

fn color_attachment(
    view: &wgpu::TextureView,
    clear: Option<[f64; 4]>,
) -> Option<wgpu::RenderPassColorAttachment<'_>> {
    let load = match clear {
        Some([r, g, b, a]) => wgpu::LoadOp::Clear(wgpu::Color { r, g, b, a }),
        None => wgpu::LoadOp::Load,
    };
    let ops = wgpu::Operations {
        load,
        store: wgpu::StoreOp::Store,
    };
    Some(wgpu::RenderPassColorAttachment {
        view,
        depth_slice: None,
        resolve_target: None,
        ops,
    })
}

fn depth_attachment(
    view: &wgpu::TextureView,
    clear: Option<f32>,
    write: bool,
) -> wgpu::RenderPassDepthStencilAttachment<'_> {
    let load = clear.map_or(wgpu::LoadOp::Load, wgpu::LoadOp::Clear);
    // Without operations the attachment is read-only, and the pass may sample it too.
    let is_written = write || clear.is_some();
    let depth_ops = is_written.then_some(wgpu::Operations {
        load,
        store: wgpu::StoreOp::Store,
    });
    wgpu::RenderPassDepthStencilAttachment {
        view,
        depth_ops,
        stencil_ops: None,
    }
}

fn render_pass<'e>(
    name: &str,
    encoder: &'e mut wgpu::CommandEncoder,
    colors: &[Option<wgpu::RenderPassColorAttachment<'_>>],
    depth: Option<wgpu::RenderPassDepthStencilAttachment<'_>>,
    query: Option<&wgpu_profiler::GpuProfilerQuery>,
) -> wgpu::RenderPass<'e> {
    encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        label: Some(name),
        color_attachments: colors,
        depth_stencil_attachment: depth,
        timestamp_writes: query.and_then(|query| query.render_pass_timestamp_writes()),
        occlusion_query_set: None,
        multiview_mask: None,
    })
}

fn encode_draw(
    draw: &MadeDraw,
    name: &str,
    encoder: &mut wgpu::CommandEncoder,
    timer: Option<&Timer>,
) {
    let query = timer.map(|timer| timer.profiler().begin_pass_query(name, encoder));
    let colors: Vec<_> = draw
        .colors
        .iter()
        .map(|(view, clear)| color_attachment(view, *clear))
        .collect();
    let depth = draw
        .depth
        .as_ref()
        .map(|(view, clear, write)| depth_attachment(view, *clear, *write));
    {
        let mut pass = render_pass(name, encoder, &colors, depth, query.as_ref());
        pass.set_pipeline(&draw.pipeline);
        for (index, group) in (0u32..).zip(&draw.groups) {
            pass.set_bind_group(index, group.as_ref(), &[]);
        }
        match &draw.call {
            MadeCall::Direct {
                vertices,
                instances,
            } => pass.draw(0..*vertices, 0..*instances),
            MadeCall::Indirect(buffer) => pass.draw_indirect(buffer, 0),
        }
    }
    end(timer, query, encoder);
}
