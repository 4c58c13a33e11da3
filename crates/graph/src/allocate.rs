//! Phase 9, second half: pipelines and bind groups of the live passes.

use crate::{
    execute::ExecuteError,
    link::{BindTarget, LinkedCall, LinkedDraw, LinkedGroups, LinkedProgram, LinkedStep},
    memory::Memory,
    resolve::{Part, Target},
    wgsl::Shader,
};
use naga::ShaderStage;
use std::{borrow::Cow, collections::HashMap, sync::Arc};

/// A step with everything it needs on the device.
pub(crate) enum MadeStep {
    Draw(MadeDraw),
    Dispatch {
        pipeline: wgpu::ComputePipeline,
        groups: Vec<Option<wgpu::BindGroup>>,
        size: MadeGroups,
    },
    CopyTexture {
        from: wgpu::Texture,
        to: wgpu::Texture,
        origins: [Target; 2],
        mips: Vec<wgpu::Extent3d>,
    },
    CopyBuffer {
        from: wgpu::Buffer,
        to: wgpu::Buffer,
    },
    ClearTexture {
        views: Vec<wgpu::TextureView>,
        depth: bool,
        value: [f64; 4],
    },
    ClearBuffer(wgpu::Buffer),
}

pub(crate) struct MadeDraw {
    pub pipeline: wgpu::RenderPipeline,
    pub groups: Vec<Option<wgpu::BindGroup>>,
    pub colors: Vec<(wgpu::TextureView, Option<[f64; 4]>)>,
    /// View, value it is cleared to, whether the draw writes it.
    pub depth: Option<(wgpu::TextureView, Option<f32>, bool)>,
    pub call: MadeCall,
}

pub(crate) enum MadeCall {
    Direct { vertices: u32, instances: u32 },
    Indirect(wgpu::Buffer),
}

pub(crate) enum MadeGroups {
    Fixed([u32; 3]),
    Indirect(wgpu::Buffer),
}

/// Makes pipelines and bind groups.
pub(crate) struct Maker<'a> {
    device: &'a wgpu::Device,
    memory: &'a Memory,
    modules: HashMap<String, wgpu::ShaderModule>,
}

/// The vertex stage of a full-screen pass: one triangle over the whole target.
const FULLSCREEN: &str =
    "@vertex fn fullscreen(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> {
    return vec4<f32>(f32(index & 1u) * 4.0 - 1.0, f32(index >> 1u) * 4.0 - 1.0, 0.0, 1.0);
}";

impl<'a> Maker<'a> {
    pub fn new(device: &'a wgpu::Device, memory: &'a Memory) -> Self {
        Self {
            device,
            memory,
            modules: HashMap::new(),
        }
    }

    pub fn step(&mut self, label: &str, step: &LinkedStep) -> Result<MadeStep, ExecuteError> {
        match step {
            LinkedStep::Draw(draw) => self.draw(label, draw).map(MadeStep::Draw),
            LinkedStep::Dispatch { program, groups } => {
                let module = self.module(&program.shader);
                let (layout, bind_groups) = self.bindings(label, program)?;
                let pipeline =
                    self.device
                        .create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
                            label: Some(label),
                            layout: Some(&layout),
                            module: &module,
                            entry_point: program
                                .entries
                                .first()
                                .map(|&entry| program.shader.entry_name(entry)),
                            compilation_options: options(&constants(program)),
                            cache: None,
                        });
                let size = match groups {
                    LinkedGroups::Fixed(groups) => MadeGroups::Fixed(*groups),
                    LinkedGroups::Indirect(buffer) => {
                        MadeGroups::Indirect(self.memory.buffer(*buffer)?.clone())
                    }
                };
                Ok(MadeStep::Dispatch {
                    pipeline,
                    groups: bind_groups,
                    size,
                })
            }
            LinkedStep::CopyTexture { from, to } => {
                let source = self.memory.texture(from.id)?.clone();
                let mips = (0..from.part.mips.len() as u32).map(|mip| wgpu::Extent3d {
                    width: (source.width() >> (from.part.mips.start + mip)).max(1),
                    height: (source.height() >> (from.part.mips.start + mip)).max(1),
                    depth_or_array_layers: from.part.layers.len() as u32,
                });
                let mips = mips.collect();
                let target = self.memory.texture(to.id)?.clone();
                Ok(MadeStep::CopyTexture {
                    from: source,
                    to: target,
                    origins: [from.clone(), to.clone()],
                    mips,
                })
            }
            LinkedStep::CopyBuffer { from, to } => Ok(MadeStep::CopyBuffer {
                from: self.memory.buffer(*from)?.clone(),
                to: self.memory.buffer(*to)?.clone(),
            }),
            LinkedStep::ClearTexture { target, value } => {
                let mut views = Vec::new();
                for mip in target.part.mips.clone() {
                    for layer in target.part.layers.clone() {
                        let part = Part {
                            mips: mip..mip + 1,
                            layers: layer..layer + 1,
                        };
                        views.push(self.memory.view(
                            &Target {
                                id: target.id,
                                part,
                            },
                            wgpu::TextureViewDimension::D2,
                        )?);
                    }
                }
                let depth = self
                    .memory
                    .texture(target.id)?
                    .format()
                    .is_depth_stencil_format();
                Ok(MadeStep::ClearTexture {
                    views,
                    depth,
                    value: *value,
                })
            }
            LinkedStep::ClearBuffer(buffer) => {
                Ok(MadeStep::ClearBuffer(self.memory.buffer(*buffer)?.clone()))
            }
        }
    }

    fn draw(&mut self, label: &str, draw: &LinkedDraw) -> Result<MadeDraw, ExecuteError> {
        let program = &draw.program;
        let module = self.module(&program.shader);
        let (layout, groups) = self.bindings(label, program)?;
        let constants = constants(program);
        let entry = |stage: ShaderStage| {
            program
                .stages
                .iter()
                .position(|known| *known == stage)
                .map(|index| program.shader.entry_name(program.entries[index]))
        };
        let fullscreen = draw.fullscreen.then(|| {
            self.device
                .create_shader_module(wgpu::ShaderModuleDescriptor {
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
                module: &module,
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
            module: &module,
            entry_point: Some(name),
            compilation_options: options(&constants),
            targets: &targets,
        });
        let pipeline = self
            .device
            .create_render_pipeline(&wgpu::RenderPipelineDescriptor {
                label: Some(label),
                layout: Some(&layout),
                vertex,
                primitive: draw.primitive,
                depth_stencil: draw.depth.as_ref().map(|depth| depth.state.clone()),
                multisample: wgpu::MultisampleState::default(),
                fragment,
                multiview_mask: None,
                cache: None,
            });
        let colors = draw
            .colors
            .iter()
            .map(|color| {
                Ok((
                    self.memory
                        .view(&color.target, wgpu::TextureViewDimension::D2)?,
                    color.clear,
                ))
            })
            .collect::<Result<_, ExecuteError>>()?;
        let depth = match &draw.depth {
            Some(depth) => {
                let view = self
                    .memory
                    .view(&depth.target, wgpu::TextureViewDimension::D2)?;
                Some((
                    view,
                    depth.clear,
                    depth.state.depth_write_enabled == Some(true),
                ))
            }
            None => None,
        };
        let call = match &draw.call {
            LinkedCall::Direct {
                vertices,
                instances,
            } => MadeCall::Direct {
                vertices: *vertices,
                instances: *instances,
            },
            LinkedCall::Indirect(buffer) => {
                MadeCall::Indirect(self.memory.buffer(*buffer)?.clone())
            }
        };
        Ok(MadeDraw {
            pipeline,
            groups,
            colors,
            depth,
            call,
        })
    }

    fn module(&mut self, shader: &Arc<Shader>) -> wgpu::ShaderModule {
        let name = shader.source.file.name.to_string();
        let make = || {
            self.device
                .create_shader_module(wgpu::ShaderModuleDescriptor {
                    label: Some(&name),
                    source: wgpu::ShaderSource::Naga(Cow::Owned(shader.module.clone())),
                })
        };
        self.modules
            .entry(name.clone())
            .or_insert_with(make)
            .clone()
    }

    /// The pipeline layout and the bind groups of a program; groups without a binding are left out.
    fn bindings(
        &self,
        label: &str,
        program: &LinkedProgram,
    ) -> Result<(wgpu::PipelineLayout, Vec<Option<wgpu::BindGroup>>), ExecuteError> {
        let count = program
            .bindings
            .iter()
            .map(|binding| binding.group + 1)
            .max()
            .unwrap_or(0);
        let (mut layouts, mut groups) = (Vec::new(), Vec::new());
        for group in 0..count {
            let of_group: Vec<_> = program
                .bindings
                .iter()
                .filter(|binding| binding.group == group)
                .collect();
            if of_group.is_empty() {
                layouts.push(None);
                groups.push(None);
                continue;
            }
            let entries: Vec<wgpu::BindGroupLayoutEntry> = of_group
                .iter()
                .map(|binding| wgpu::BindGroupLayoutEntry {
                    binding: binding.binding,
                    visibility: binding.visibility,
                    ty: binding.ty,
                    count: None,
                })
                .collect();
            let layout = self
                .device
                .create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
                    label: Some(label),
                    entries: &entries,
                });
            let bound: Vec<(u32, Bound)> = of_group
                .iter()
                .map(|binding| Ok((binding.binding, self.bound(label, &binding.target)?)))
                .collect::<Result<_, ExecuteError>>()?;
            let entries: Vec<wgpu::BindGroupEntry<'_>> = bound
                .iter()
                .map(|(binding, bound)| wgpu::BindGroupEntry {
                    binding: *binding,
                    resource: match bound {
                        Bound::Buffer(buffer) => buffer.as_entire_binding(),
                        Bound::View(view) => wgpu::BindingResource::TextureView(view),
                        Bound::Sampler(sampler) => wgpu::BindingResource::Sampler(sampler),
                    },
                })
                .collect();
            groups.push(Some(self.device.create_bind_group(
                &wgpu::BindGroupDescriptor {
                    label: Some(label),
                    layout: &layout,
                    entries: &entries,
                },
            )));
            layouts.push(Some(layout));
        }
        let layouts: Vec<Option<&wgpu::BindGroupLayout>> =
            layouts.iter().map(Option::as_ref).collect();
        let layout = self
            .device
            .create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
                label: Some(label),
                bind_group_layouts: &layouts,
                immediate_size: 0,
            });
        Ok((layout, groups))
    }

    fn bound(&self, label: &str, target: &BindTarget) -> Result<Bound, ExecuteError> {
        Ok(match target {
            BindTarget::Buffer(id) => Bound::Buffer(self.memory.buffer(*id)?.clone()),
            BindTarget::Texture { target, dimension } => {
                Bound::View(self.memory.view(target, *dimension)?)
            }
            BindTarget::Sampler(id) => Bound::Sampler(self.memory.sampler(*id)?.clone()),
            BindTarget::Params(bytes) => {
                let buffer = self.device.create_buffer(&wgpu::BufferDescriptor {
                    label: Some(&format!("{label} params")),
                    size: bytes.len() as u64,
                    usage: wgpu::BufferUsages::UNIFORM,
                    mapped_at_creation: true,
                });
                match buffer.get_mapped_range_mut(..) {
                    Ok(mut mapped) => mapped.copy_from_slice(bytes),
                    Err(_) => {
                        return Err(ExecuteError::Internal(
                            "the params of a pass could not be uploaded",
                        ));
                    }
                }
                buffer.unmap();
                Bound::Buffer(buffer)
            }
        })
    }
}

enum Bound {
    Buffer(wgpu::Buffer),
    View(wgpu::TextureView),
    Sampler(wgpu::Sampler),
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
