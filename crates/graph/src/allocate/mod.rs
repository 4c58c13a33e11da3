//! Phase 9, second half: pipelines of the live passes (here) and what is bound to them ([`bind`]).

mod bind;

pub(crate) use bind::{Binder, MadeCall, MadeDraw, MadeGroups, MadeStep, upload};

use crate::{
    link::{LinkedDraw, LinkedProgram, LinkedStep},
    wgsl::Shader,
};
use naga::ShaderStage;
use std::{borrow::Cow, collections::HashMap, sync::Arc};

/// The pipeline of a draw or dispatch, with the layouts of its bind groups.
#[derive(Clone)]
pub(crate) struct Pipeline {
    pub kind: PipelineKind,
    pub layouts: Vec<Option<wgpu::BindGroupLayout>>,
}

#[derive(Clone)]
pub(crate) enum PipelineKind {
    Render(wgpu::RenderPipeline),
    Compute(wgpu::ComputePipeline),
}

/// Makes pipelines; every shader is compiled once.
#[derive(Default)]
pub(crate) struct Pipelines {
    modules: HashMap<String, (Arc<Shader>, wgpu::ShaderModule)>,
}

/// The vertex stage of a full-screen pass: one triangle over the whole target.
const FULLSCREEN: &str =
    "@vertex fn fullscreen(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> {
    return vec4<f32>(f32(index & 1u) * 4.0 - 1.0, f32(index >> 1u) * 4.0 - 1.0, 0.0, 1.0);
}";

impl Pipelines {
    /// The pipeline of a step; copies and clears have none.
    pub fn of(
        &mut self,
        device: &wgpu::Device,
        label: &str,
        step: &LinkedStep,
    ) -> Option<Pipeline> {
        let (LinkedStep::Draw(LinkedDraw { program, .. }) | LinkedStep::Dispatch { program, .. }) =
            step
        else {
            return None;
        };
        let module = self.module(device, &program.shader);
        let layouts = layouts(device, label, program);
        let bound: Vec<_> = layouts.iter().map(Option::as_ref).collect();
        let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some(label),
            bind_group_layouts: &bound,
            immediate_size: 0,
        });
        let kind = match step {
            LinkedStep::Draw(draw) => {
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
        let name = shader.source.file.name.to_string();
        match self.modules.get(&name) {
            Some((known, module)) if known == shader => module.clone(),
            _ => {
                let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
                    label: Some(&name),
                    source: wgpu::ShaderSource::Naga(Cow::Owned(shader.module.clone())),
                });
                self.modules.insert(name, (shader.clone(), module.clone()));
                module
            }
        }
    }
}

/// Whether the pipeline of one step serves for another.
pub(crate) fn same_pipeline(a: &LinkedStep, b: &LinkedStep) -> bool {
    match (a, b) {
        (LinkedStep::Draw(a), LinkedStep::Draw(b)) => {
            let formats = |draw: &LinkedDraw| -> Vec<_> {
                draw.colors
                    .iter()
                    .map(|color| (color.format, color.blend))
                    .collect()
            };
            let depth = |draw: &LinkedDraw| draw.depth.as_ref().map(|depth| depth.state.clone());
            same_program(&a.program, &b.program)
                && a.fullscreen == b.fullscreen
                && a.primitive == b.primitive
                && formats(a) == formats(b)
                && depth(a) == depth(b)
        }
        (LinkedStep::Dispatch { program: a, .. }, LinkedStep::Dispatch { program: b, .. }) => {
            same_program(a, b)
        }
        _ => false,
    }
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
        && a.stages == b.stages
        && a.constants == b.constants
        && slots(a) == slots(b)
}

fn render_pipeline(
    device: &wgpu::Device,
    label: &str,
    draw: &LinkedDraw,
    module: &wgpu::ShaderModule,
    layout: &wgpu::PipelineLayout,
) -> wgpu::RenderPipeline {
    let program = &draw.program;
    let constants = constants(program);
    let entry = |stage: ShaderStage| {
        program
            .stages
            .iter()
            .position(|known| *known == stage)
            .map(|index| program.shader.entry_name(program.entries[index]))
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
    let targets: Vec<Option<wgpu::ColorTargetState>> = draw
        .colors
        .iter()
        .map(|color| {
            Some(wgpu::ColorTargetState {
                format: color.format,
                blend: color.blend,
                write_mask: wgpu::ColorWrites::ALL,
            })
        })
        .collect();
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
        depth_stencil: draw.depth.as_ref().map(|depth| depth.state.clone()),
        multisample: wgpu::MultisampleState::default(),
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
