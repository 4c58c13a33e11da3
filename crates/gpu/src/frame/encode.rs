//! Encodes the steps of passes as wgpu commands.

use super::{cpu::CpuTurn, statistics::Counters, timer::Timer};
use crate::error::ExecuteError;
use crate::pipelines::handles::{GpuAttachment, GpuOperand, GpuProgram, Handles, PipelineKind};
use skiagraph_graph::step::{Dispatch, Draw, DrawCall, Groups, Step};
use smallvec::SmallVec;

/// Timer and counters of a frame; `None` if they were not requested.
#[derive(Clone, Copy, Default)]
pub(super) struct Meters<'t> {
    pub timer: Option<&'t Timer>,
    pub counters: Option<&'t Counters>,
}

/// Encodes the steps of a pass, under its name in captures of graphics debuggers. The render or
/// compute pass of a single draw or dispatch carries the name as its label. A debug group around it
/// would repeat the name, and cost more than all else that the graph adds. So does one of work for
/// the CPU, around which the encoder changes. Without `cpu` such work is left out.
///
/// # Errors
/// Those of work for the CPU.
pub(super) fn encode_all(
    steps: &[Step<Handles>],
    name: &str,
    encoder: &mut wgpu::CommandEncoder,
    meters: Meters<'_>,
    mut cpu: Option<&mut CpuTurn<'_>>,
) -> Result<(), ExecuteError> {
    let timer = meters.timer;
    let is_split = steps.iter().any(|step| matches!(step, Step::Cpu(_)));
    let labelled = is_split || matches!(steps, [Step::Draw(_) | Step::Dispatch(_)]);
    if !labelled {
        encoder.push_debug_group(name);
    }
    for step in steps {
        match step {
            Step::Draw(draw) => encode_draw(draw, name, encoder, meters),
            Step::Dispatch(dispatch) => encode_dispatch(dispatch, name, encoder, meters),
            Step::Copy { from, to } => {
                timed(name, encoder, timer, |encoder| copy(from, to, encoder));
            }
            Step::Clear { target, value } => clear(target, *value, name, encoder, timer),
            Step::Cpu(call) => {
                if let Some(cpu) = &mut cpu {
                    // Its time on the GPU is how long that stands still for it.
                    timed(name, encoder, timer, |encoder| cpu.call(call, encoder))?;
                }
            }
        }
    }
    if !labelled {
        encoder.pop_debug_group();
    }
    Ok(())
}

fn encode_dispatch(
    dispatch: &Dispatch<Handles>,
    name: &str,
    encoder: &mut wgpu::CommandEncoder,
    Meters { timer, counters }: Meters<'_>,
) {
    let query = timer.map(|timer| timer.profiler().begin_pass_query(name, encoder));
    let timestamps = query.as_ref();
    {
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
            label: Some(name),
            timestamp_writes: timestamps.and_then(|it| it.compute_pass_timestamp_writes()),
        });
        if let Some(timer) = timer {
            timer.open_compute(&mut pass);
        }
        let counted = counters.and_then(Counters::next);
        if let Some((set, index)) = counted {
            pass.begin_pipeline_statistics_query(set, index);
        }
        run(dispatch, &mut pass);
        if counted.is_some() {
            pass.end_pipeline_statistics_query();
        }
    }
    end(timer, query, encoder);
}

/// Encodes a dispatch into an open compute pass.
fn run(dispatch: &Dispatch<Handles>, pass: &mut wgpu::ComputePass<'_>) {
    let GpuProgram {
        pipeline: PipelineKind::Compute(pipeline),
        groups,
    } = &dispatch.program
    else {
        return;
    };
    pass.set_pipeline(pipeline);
    for (index, group) in groups {
        pass.set_bind_group(*index, group, &[]);
    }
    match &dispatch.groups {
        Groups::Direct([x, y, z]) => pass.dispatch_workgroups(*x, *y, *z),
        Groups::Indirect((buffer, offset)) => pass.dispatch_workgroups_indirect(buffer, *offset),
    }
}

/// The compute pass that several passes in a row share if they have no other steps than dispatches
/// and clears that were encoded before it, and are not measured: a compute pass of its own costs
/// wgpu two command buffers.
#[derive(Default)]
pub(super) struct SharedPass(Option<wgpu::ComputePass<'static>>);

impl SharedPass {
    /// Encodes the dispatches of a pass under its name in captures of graphics debuggers.
    pub fn dispatch(
        &mut self,
        steps: &[Step<Handles>],
        name: &str,
        encoder: &mut wgpu::CommandEncoder,
    ) {
        let is_dispatch = |step: &Step<_>| matches!(step, Step::Dispatch(_));
        if !steps.iter().any(is_dispatch) {
            return;
        }
        let pass = self.0.get_or_insert_with(|| {
            let pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
            pass.forget_lifetime()
        });
        pass.push_debug_group(name);
        for step in steps {
            if let Step::Dispatch(dispatch) = step {
                run(dispatch, pass);
            }
        }
        pass.pop_debug_group();
    }

    /// Ends the compute pass, so that the encoder takes other commands.
    pub fn end(&mut self) {
        self.0 = None;
    }
}

/// Encodes the clears of buffers among the steps of a pass.
pub(super) fn clear_buffers(steps: &[Step<Handles>], encoder: &mut wgpu::CommandEncoder) {
    for step in steps {
        if let Step::Clear {
            target: GpuOperand::Buffer { buffer, range },
            ..
        } = step
        {
            encoder.clear_buffer(buffer, range.start, Some(range.end - range.start));
        }
    }
}

fn copy(from: &GpuOperand, to: &GpuOperand, encoder: &mut wgpu::CommandEncoder) {
    match (from, to) {
        (
            GpuOperand::Buffer { buffer, range },
            GpuOperand::Buffer {
                buffer: target,
                range: place,
            },
        ) => {
            let bytes = (range.end - range.start).min(place.end - place.start);
            encoder.copy_buffer_to_buffer(buffer, range.start, target, place.start, bytes);
        }
        (
            GpuOperand::Texture {
                texture,
                part,
                mips,
                ..
            },
            GpuOperand::Texture {
                texture: target,
                part: place,
                ..
            },
        ) => {
            for (mip, extent) in (0u32..).zip(mips) {
                encoder.copy_texture_to_texture(
                    layers_from(texture, part.mips.start + mip, part.layers.start),
                    layers_from(target, place.mips.start + mip, place.layers.start),
                    *extent,
                );
            }
        }
        // Linking has seen to it that both are of one kind.
        _ => {}
    }
}

/// Returns the place of a copy in a mip of a texture, from a layer on.
pub(super) fn layers_from(
    texture: &wgpu::Texture,
    mip: u32,
    layer: u32,
) -> wgpu::TexelCopyTextureInfo<'_> {
    let mut place = texture.as_image_copy();
    (place.mip_level, place.origin.z) = (mip, layer);
    place
}

/// Encodes commands that are no pass; in a timed frame it takes their time.
fn timed<T>(
    name: &str,
    encoder: &mut wgpu::CommandEncoder,
    timer: Option<&Timer>,
    encode: impl FnOnce(&mut wgpu::CommandEncoder) -> T,
) -> T {
    let query = timer.map(|timer| timer.profiler().begin_query(name, encoder));
    let encoded = encode(encoder);
    end(timer, query, encoder);
    encoded
}

fn clear(
    target: &GpuOperand,
    value: [f64; 4],
    name: &str,
    encoder: &mut wgpu::CommandEncoder,
    timer: Option<&Timer>,
) {
    match target {
        GpuOperand::Buffer { buffer, range } => {
            let bytes = range.end - range.start;
            timed(name, encoder, timer, |encoder| {
                encoder.clear_buffer(buffer, range.start, Some(bytes));
            });
        }
        GpuOperand::Texture { texture, views, .. } => {
            for view in views {
                let query = timer.map(|timer| timer.profiler().begin_pass_query(name, encoder));
                clear_view(view, texture.format(), value, name, encoder, query.as_ref());
                end(timer, query, encoder);
            }
        }
    }
}

/// Clears one mip of one layer.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a depth is f32, a stencil a small whole number"
)]
pub(super) fn clear_view(
    target: &GpuAttachment,
    format: wgpu::TextureFormat,
    value: [f64; 4],
    name: &str,
    encoder: &mut wgpu::CommandEncoder,
    query: Option<&wgpu_profiler::GpuProfilerQuery>,
) {
    let is_depth = format.is_depth_stencil_format();
    let color = (!is_depth).then(|| color_attachment(target, None, Some(value)));
    let depth = format.has_depth_aspect().then_some(value[0] as f32);
    let stencil = format.has_stencil_aspect().then_some(value[1] as u32);
    let depth_stencil = is_depth.then(|| wgpu::RenderPassDepthStencilAttachment {
        view: &target.view,
        depth_ops: operations(depth, false, target.store),
        stencil_ops: operations(stencil, false, target.store),
    });
    render_pass(name, encoder, color.as_slice(), depth_stencil, query);
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

/// Returns the placeholder attachment of a draw without attachments; its content is discarded.
fn canvas_attachment(canvas: &GpuAttachment) -> Option<wgpu::RenderPassColorAttachment<'_>> {
    let mut attachment = color_attachment(canvas, None, Some([0.0; 4]))?;
    attachment.ops.store = wgpu::StoreOp::Discard;
    Some(attachment)
}

fn color_attachment<'v>(
    target: &'v GpuAttachment,
    resolve: Option<&'v GpuAttachment>,
    clear: Option<[f64; 4]>,
) -> Option<wgpu::RenderPassColorAttachment<'v>> {
    let load = match clear {
        Some([r, g, b, a]) => wgpu::LoadOp::Clear(wgpu::Color { r, g, b, a }),
        None => wgpu::LoadOp::Load,
    };
    Some(wgpu::RenderPassColorAttachment {
        view: &target.view,
        depth_slice: target.slice,
        resolve_target: resolve.map(|resolve| &resolve.view),
        ops: wgpu::Operations {
            load,
            store: target.store,
        },
    })
}

/// Effects of a draw on depths or stencils. Without operations the attachment is read-only, and the
/// pass may sample it too.
fn operations<V: Default>(
    clear: Option<V>,
    write: bool,
    store: wgpu::StoreOp,
) -> Option<wgpu::Operations<V>> {
    let is_written = write || clear.is_some();
    is_written.then(|| wgpu::Operations {
        load: clear.map_or(wgpu::LoadOp::Load, wgpu::LoadOp::Clear),
        store,
    })
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
    draw: &Draw<Handles>,
    name: &str,
    encoder: &mut wgpu::CommandEncoder,
    Meters { timer, counters }: Meters<'_>,
) {
    let GpuProgram {
        pipeline: PipelineKind::Render(pipeline),
        groups,
    } = &draw.program
    else {
        return;
    };
    let query = timer.map(|timer| timer.profiler().begin_pass_query(name, encoder));
    // Every frame comes here: on the stack, as many as devices have.
    let colors = draw.colors.iter().map(|color| {
        let color = color.as_ref()?;
        color_attachment(&color.target, color.resolve.as_ref(), color.clear)
    });
    let colors = colors.chain(draw.canvas.iter().map(canvas_attachment));
    let colors: SmallVec<[_; 8]> = colors.collect();
    let depth = draw.depth.as_ref();
    let stencil = draw.stencil.as_ref();
    let target = depth.map(|depth| &depth.target);
    let target = target.or(stencil.map(|stencil| &stencil.target));
    let target = target.map(|target| wgpu::RenderPassDepthStencilAttachment {
        view: &target.view,
        depth_ops: depth.and_then(|depth| operations(depth.clear, depth.write, depth.target.store)),
        stencil_ops: stencil.and_then(|stencil| {
            let is_read_only = stencil.state.is_read_only(draw.primitive.cull_mode);
            operations(stencil.clear, !is_read_only, stencil.target.store)
        }),
    });
    {
        let mut pass = render_pass(name, encoder, &colors, target, query.as_ref());
        pass.set_pipeline(pipeline);
        if let Some(area) = draw.area {
            let [x, y, width, height] = area.map(|edge| edge as f32);
            pass.set_viewport(x, y, width, height, 0.0, 1.0);
            pass.set_scissor_rect(area[0], area[1], area[2], area[3]);
        }
        if let Some(stencil) = stencil {
            pass.set_stencil_reference(stencil.reference);
        }
        let mut blended = draw.colors.iter().flatten();
        if let Some([r, g, b, a]) = blended.find_map(|color| color.blend_constant) {
            pass.set_blend_constant(wgpu::Color { r, g, b, a });
        }
        for (index, group) in groups {
            pass.set_bind_group(*index, group, &[]);
        }
        let counted = counters.and_then(Counters::next);
        if let Some((set, index)) = counted {
            pass.begin_pipeline_statistics_query(set, index);
        }
        match &draw.call {
            DrawCall::Direct {
                vertices,
                instances,
            } => pass.draw(vertices.clone(), instances.clone()),
            DrawCall::Indirect((buffer, offset)) => pass.draw_indirect(buffer, *offset),
        }
        if counted.is_some() {
            pass.end_pipeline_statistics_query();
        }
    }
    end(timer, query, encoder);
}
