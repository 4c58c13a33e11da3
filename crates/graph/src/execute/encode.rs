//! Steps become commands.

use crate::{
    allocate::{MadeCall, MadeDraw, MadeGroups, MadeStep},
    timing::Timer,
};

/// Encodes the steps of a pass, under its name in captures. A single draw or dispatch bears it as the label of its render or
/// compute pass; a debug group around that would say it twice, and costs more than all else that the graph adds.
pub(super) fn encode_all(
    steps: &[MadeStep],
    name: &str,
    encoder: &mut wgpu::CommandEncoder,
    timer: Option<&Timer>,
) {
    let labelled = matches!(steps, [MadeStep::Draw(_) | MadeStep::Dispatch { .. }]);
    if !labelled {
        encoder.push_debug_group(name);
    }
    for step in steps {
        encode(step, name, encoder, timer);
    }
    if !labelled {
        encoder.pop_debug_group();
    }
}

/// Encodes a step; with a timer, under the name of its pass.
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
                for (index, group) in groups {
                    pass.set_bind_group(*index, group, &[]);
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

pub(super) fn depth_attachment(
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

pub(super) fn render_pass<'e>(
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
        for (index, group) in &draw.groups {
            pass.set_bind_group(*index, group, &[]);
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
