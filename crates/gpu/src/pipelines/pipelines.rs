//! Creates pipelines: one for each draw or dispatch; shaders are compiled once.

use super::handles::PipelineKind;
use naga::ShaderStage;
use skiagraph_graph::{
    Ids, LinkedProgram, Shader,
    step::{ColorTarget, Dispatch, Draw, Step},
};
use std::{borrow::Cow, collections::HashMap, sync::Arc};

/// The pipeline of a draw or dispatch, with the layouts of its bind groups.
#[derive(Clone)]
pub(crate) struct Pipeline {
    pub kind: PipelineKind,
    pub layouts: Vec<Option<wgpu::BindGroupLayout>>,
}

/// Creates pipelines and keeps the compiled shaders.
#[derive(Clone, Default)]
pub(crate) struct Pipelines {
    modules: HashMap<String, (Arc<Shader>, wgpu::ShaderModule)>,
    /// Pipelines of the next plan that another thread has created, by pass name; one for each step.
    prepared: HashMap<String, Vec<Option<Pipeline>>>,
}

/// The vertex stage of a full-screen pass: one triangle over the whole target.
const FULLSCREEN: &str =
    "@vertex fn fullscreen(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> {
    return vec4<f32>(f32(index & 1u) * 4.0 - 1.0, f32(index >> 1u) * 4.0 - 1.0, 0.0, 1.0);
}";

impl Pipelines {
    /// Creates pipelines of a pass for the next plan. `steps` yields every step; `None` for a step
    /// that needs no new pipeline.
    pub fn prepare<'s>(
        &mut self,
        device: &wgpu::Device,
        label: &str,
        steps: impl Iterator<Item = Option<&'s Step<Ids>>>,
    ) {
        let made = steps.map(|step| self.make(device, label, step?)).collect();
        self.prepared.insert(label.to_owned(), made);
    }

    /// Drops the pipelines prepared for a plan that was put in or refused.
    pub fn forget_prepared(&mut self) {
        self.prepared.clear();
    }

    /// Returns the pipeline of the pass's step at `index`; `None` for copies and clears.
    pub fn get_or_make(
        &mut self,
        device: &wgpu::Device,
        label: &str,
        (index, step): (usize, &Step<Ids>),
    ) -> Option<Pipeline> {
        let prepared = self
            .prepared
            .get_mut(label)
            .and_then(|made| made.get_mut(index));
        match prepared.and_then(Option::take) {
            Some(made) => Some(made),
            None => self.make(device, label, step),
        }
    }

    fn make(&mut self, device: &wgpu::Device, label: &str, step: &Step<Ids>) -> Option<Pipeline> {
        let program = step.program()?;
        let module = self.module(device, &program.shader);
        let layouts = layouts(device, label, program);
        let bound: Vec<_> = layouts.iter().map(Option::as_ref).collect();
        let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some(label),
            bind_group_layouts: &bound,
            immediate_size: 0,
        });
        let kind = match step {
            Step::Draw(draw) => {
                PipelineKind::Render(render_pipeline(device, label, draw, &module, &layout))
            }
            _ => PipelineKind::Compute(
                device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
                    label: Some(label),
                    layout: Some(&layout),
                    module: &module,
                    entry_point: program
                        .entries
                        .first()
                        .map(|&entry| program.shader.entry_name(entry)),
                    compilation_options: options(&constants(program)),
                    cache: None,
                }),
            ),
        };
        Some(Pipeline { kind, layouts })
    }

    fn module(&mut self, device: &wgpu::Device, shader: &Arc<Shader>) -> wgpu::ShaderModule {
        let name = shader.file().to_owned();
        match self.modules.get(&name) {
            Some((known, module)) if known == shader => module.clone(),
            _ => {
                let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
                    label: Some(&name),
                    source: wgpu::ShaderSource::Naga(Cow::Owned(shader.module().clone())),
                });
                self.modules.insert(name, (shader.clone(), module.clone()));
                module
            }
        }
    }
}

/// True if two steps can use the same pipeline.
pub(crate) fn same_pipeline(a: &Step<Ids>, b: &Step<Ids>) -> bool {
    match (a, b) {
        (Step::Draw(a), Step::Draw(b)) => {
            let targets = |draw: &Draw<Ids>| -> Vec<_> {
                let color =
                    |color: &ColorTarget<Ids>| (color.target.format, color.blend, color.write);
                draw.colors.iter().map(color).collect()
            };
            same_program(&a.program, &b.program)
                && a.fullscreen == b.fullscreen
                && a.primitive == b.primitive
                && targets(a) == targets(b)
                && a.canvas.is_some() == b.canvas.is_some()
                && depth_stencil(a) == depth_stencil(b)
                && samples(a) == samples(b)
        }
        (
            Step::Dispatch(Dispatch { program: a, .. }),
            Step::Dispatch(Dispatch { program: b, .. }),
        ) => same_program(a, b),
        _ => false,
    }
}

/// Depth and stencil of a draw, as its pipeline has them.
fn depth_stencil(draw: &Draw<Ids>) -> Option<wgpu::DepthStencilState> {
    let target = draw.depth.as_ref().map(|depth| &depth.target);
    let target = target.or(draw.stencil.as_ref().map(|stencil| &stencil.target))?;
    let depth = draw.depth.as_ref();
    let has_depth = target.format.has_depth_aspect();
    Some(wgpu::DepthStencilState {
        format: target.format,
        // An aspect that no field names is left alone.
        depth_write_enabled: has_depth.then_some(depth.is_some_and(|depth| depth.write)),
        depth_compare: has_depth
            .then_some(depth.map_or(wgpu::CompareFunction::Always, |depth| depth.compare)),
        stencil: draw
            .stencil
            .as_ref()
            .map(|stencil| stencil.state.clone())
            .unwrap_or_default(),
        bias: depth.map(|depth| depth.bias).unwrap_or_default(),
    })
}

/// Samples of the attachments, which all have as many.
fn samples(draw: &Draw<Ids>) -> u32 {
    let colors = draw.colors.iter().map(|color| color.target.samples);
    let depth = draw.depth.iter().map(|depth| depth.target.samples);
    let stencil = draw.stencil.iter().map(|stencil| stencil.target.samples);
    colors.chain(depth).chain(stencil).next().unwrap_or(1)
}

fn same_program(a: &LinkedProgram, b: &LinkedProgram) -> bool {
    let slots = |program: &LinkedProgram| -> Vec<_> {
        let bindings = program.bindings.iter();
        bindings
            .map(|bound| (bound.group, bound.binding, bound.ty, bound.visibility))
            .collect()
    };
    a.shader == b.shader
        && a.entries == b.entries
        && a.constants == b.constants
        && slots(a) == slots(b)
}

fn render_pipeline(
    device: &wgpu::Device,
    label: &str,
    draw: &Draw<Ids>,
    module: &wgpu::ShaderModule,
    layout: &wgpu::PipelineLayout,
) -> wgpu::RenderPipeline {
    let program = &draw.program;
    let constants = constants(program);
    let entry = |stage: ShaderStage| {
        let entry = program.entry(stage)?;
        Some(program.shader.entry_name(entry))
    };
    let fullscreen = draw.fullscreen.then(|| {
        device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some("fullscreen"),
            source: wgpu::ShaderSource::Wgsl(Cow::Borrowed(FULLSCREEN)),
        })
    });
    let vertex = match &fullscreen {
        Some(module) => wgpu::VertexState {
            module,
            entry_point: Some("fullscreen"),
            compilation_options: options(&[]),
            buffers: &[],
        },
        None => wgpu::VertexState {
            module,
            entry_point: entry(ShaderStage::Vertex),
            compilation_options: options(&constants),
            buffers: &[],
        },
    };
    let colors = draw.colors.iter().map(|color| wgpu::ColorTargetState {
        format: color.target.format,
        blend: color.blend,
        write_mask: color.write,
    });
    let canvas = draw.canvas.iter().map(|canvas| wgpu::ColorTargetState {
        format: canvas.format,
        blend: None,
        write_mask: wgpu::ColorWrites::empty(),
    });
    let targets: Vec<Option<wgpu::ColorTargetState>> = colors.chain(canvas).map(Some).collect();
    let fragment = entry(ShaderStage::Fragment).map(|name| wgpu::FragmentState {
        module,
        entry_point: Some(name),
        compilation_options: options(&constants),
        targets: &targets,
    });
    device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some(label),
        layout: Some(layout),
        vertex,
        primitive: draw.primitive,
        depth_stencil: depth_stencil(draw),
        multisample: wgpu::MultisampleState {
            count: samples(draw),
            ..wgpu::MultisampleState::default()
        },
        fragment,
        multiview_mask: None,
        cache: None,
    })
}

/// The layouts of a program's bind groups; groups without a binding have none.
fn layouts(
    device: &wgpu::Device,
    label: &str,
    program: &LinkedProgram,
) -> Vec<Option<wgpu::BindGroupLayout>> {
    let groups = program.bindings.iter().map(|binding| binding.group + 1);
    let layout = |group: u32| {
        let entries: Vec<wgpu::BindGroupLayoutEntry> = program
            .bindings
            .iter()
            .filter(|binding| binding.group == group)
            .map(|binding| wgpu::BindGroupLayoutEntry {
                binding: binding.binding,
                visibility: binding.visibility,
                ty: binding.ty,
                count: None,
            })
            .collect();
        (!entries.is_empty()).then(|| {
            device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
                label: Some(label),
                entries: &entries,
            })
        })
    };
    (0..groups.max().unwrap_or(0)).map(layout).collect()
}

fn constants(program: &LinkedProgram) -> Vec<(&str, f64)> {
    program
        .constants
        .iter()
        .map(|(name, value)| (name.as_str(), *value))
        .collect()
}

fn options<'a>(constants: &'a [(&'a str, f64)]) -> wgpu::PipelineCompilationOptions<'a> {
    wgpu::PipelineCompilationOptions {
        constants,
        ..wgpu::PipelineCompilationOptions::default()
    }
}
