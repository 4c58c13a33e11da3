//! What is bound to the pipelines: bind groups, attachments, sources and targets of copies.

use super::{Pipeline, PipelineKind};
use crate::{
    execute::ExecuteError,
    link::{BindTarget, LinkedCall, LinkedDraw, LinkedGroups, LinkedProgram, LinkedStep},
    memory::{Histories, Memory},
    resolve::{Part, Target},
};

/// The bind groups of a program with their indices; there may be gaps.
pub(crate) type BindGroups = Vec<(u32, wgpu::BindGroup)>;

/// A step with everything it needs on the device.
pub(crate) enum MadeStep {
    Draw(MadeDraw),
    Dispatch {
        pipeline: wgpu::ComputePipeline,
        groups: BindGroups,
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
    pub groups: BindGroups,
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

/// The uniform buffer of a step's `params`, if its shader has one.
pub(crate) fn upload(
    device: &wgpu::Device,
    label: &str,
    step: &LinkedStep,
) -> Result<Option<wgpu::Buffer>, ExecuteError> {
    let Some(bytes) = step.params() else {
        return Ok(None);
    };
    let buffer = device.create_buffer(&wgpu::BufferDescriptor {
        label: Some(&format!("{label} params")),
        size: bytes.len() as u64,
        usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
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
    Ok(Some(buffer))
}

/// Binds steps to the memory of one state of the histories.
pub(crate) struct Binder<'a> {
    pub device: &'a wgpu::Device,
    pub memory: &'a Memory,
    pub histories: &'a Histories,
}

impl Binder<'_> {
    pub fn step(
        &self,
        label: &str,
        step: &LinkedStep,
        pipeline: Option<&Pipeline>,
        params: Option<&wgpu::Buffer>,
    ) -> Result<MadeStep, ExecuteError> {
        let missing = ExecuteError::Internal("a draw or dispatch has no pipeline");
        match step {
            LinkedStep::Draw(draw) => {
                let Some(Pipeline {
                    kind: PipelineKind::Render(made),
                    layouts,
                }) = pipeline
                else {
                    return Err(missing);
                };
                let groups = self.groups(label, &draw.program, layouts, params)?;
                self.draw(draw, made, groups).map(MadeStep::Draw)
            }
            LinkedStep::Dispatch { program, groups } => {
                let Some(Pipeline {
                    kind: PipelineKind::Compute(made),
                    layouts,
                }) = pipeline
                else {
                    return Err(missing);
                };
                let size = match groups {
                    LinkedGroups::Fixed(groups) => MadeGroups::Fixed(*groups),
                    LinkedGroups::Indirect(id) => MadeGroups::Indirect(self.buffer(*id)?),
                };
                Ok(MadeStep::Dispatch {
                    pipeline: made.clone(),
                    groups: self.groups(label, program, layouts, params)?,
                    size,
                })
            }
            LinkedStep::CopyTexture { from, to } => {
                let source = self.memory.texture(from.id, self.histories)?.clone();
                let mips = (0..from.part.mips.len() as u32).map(|mip| wgpu::Extent3d {
                    width: (source.width() >> (from.part.mips.start + mip)).max(1),
                    height: (source.height() >> (from.part.mips.start + mip)).max(1),
                    depth_or_array_layers: from.part.layers.len() as u32,
                });
                let mips = mips.collect();
                let target = self.memory.texture(to.id, self.histories)?.clone();
                Ok(MadeStep::CopyTexture {
                    from: source,
                    to: target,
                    origins: [from.clone(), to.clone()],
                    mips,
                })
            }
            LinkedStep::CopyBuffer { from, to } => Ok(MadeStep::CopyBuffer {
                from: self.buffer(*from)?,
                to: self.buffer(*to)?,
            }),
            LinkedStep::ClearTexture { target, value } => {
                let texture = self.memory.texture(target.id, self.histories)?;
                Ok(MadeStep::ClearTexture {
                    depth: texture.format().is_depth_stencil_format(),
                    views: self.single_views(target)?,
                    value: *value,
                })
            }
            LinkedStep::ClearBuffer(id) => Ok(MadeStep::ClearBuffer(self.buffer(*id)?)),
        }
    }

    /// A view of each mip of each layer of a part.
    pub fn single_views(&self, target: &Target) -> Result<Vec<wgpu::TextureView>, ExecuteError> {
        let id = target.id;
        let mut views = Vec::new();
        for mip in target.part.mips.clone() {
            for layer in target.part.layers.clone() {
                let part = Part {
                    mips: mip..mip + 1,
                    layers: layer..layer + 1,
                };
                views.push(self.view(&Target { id, part }, wgpu::TextureViewDimension::D2)?);
            }
        }
        Ok(views)
    }

    fn buffer(&self, id: crate::resolve::ResourceId) -> Result<wgpu::Buffer, ExecuteError> {
        self.memory.buffer(id, self.histories).cloned()
    }

    fn view(
        &self,
        target: &Target,
        dimension: wgpu::TextureViewDimension,
    ) -> Result<wgpu::TextureView, ExecuteError> {
        self.memory.view(target, dimension, self.histories)
    }

    fn draw(
        &self,
        draw: &LinkedDraw,
        pipeline: &wgpu::RenderPipeline,
        groups: BindGroups,
    ) -> Result<MadeDraw, ExecuteError> {
        let flat = wgpu::TextureViewDimension::D2;
        let colors = draw
            .colors
            .iter()
            .map(|color| Ok((self.view(&color.target, flat)?, color.clear)))
            .collect::<Result<_, ExecuteError>>()?;
        let depth = match &draw.depth {
            Some(depth) => Some((
                self.view(&depth.target, flat)?,
                depth.clear,
                depth.state.depth_write_enabled == Some(true),
            )),
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
            LinkedCall::Indirect(id) => MadeCall::Indirect(self.buffer(*id)?),
        };
        Ok(MadeDraw {
            pipeline: pipeline.clone(),
            groups,
            colors,
            depth,
            call,
        })
    }

    /// The bind groups of a program, one for each of the layouts.
    fn groups(
        &self,
        label: &str,
        program: &LinkedProgram,
        layouts: &[Option<wgpu::BindGroupLayout>],
        params: Option<&wgpu::Buffer>,
    ) -> Result<BindGroups, ExecuteError> {
        let mut groups = Vec::new();
        for (group, layout) in (0u32..).zip(layouts) {
            let Some(layout) = layout else {
                continue;
            };
            let bound: Vec<(u32, Bound)> = program
                .bindings
                .iter()
                .filter(|binding| binding.group == group)
                .map(|binding| Ok((binding.binding, self.bound(&binding.target, params)?)))
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
            let made = self.device.create_bind_group(&wgpu::BindGroupDescriptor {
                label: Some(label),
                layout,
                entries: &entries,
            });
            groups.push((group, made));
        }
        Ok(groups)
    }

    fn bound(
        &self,
        target: &BindTarget,
        params: Option<&wgpu::Buffer>,
    ) -> Result<Bound, ExecuteError> {
        Ok(match target {
            BindTarget::Buffer(id) => Bound::Buffer(self.buffer(*id)?),
            BindTarget::Texture { target, dimension } => {
                Bound::View(self.view(target, *dimension)?)
            }
            BindTarget::Sampler(id) => Bound::Sampler(self.memory.sampler(*id)?.clone()),
            BindTarget::Params(_) => Bound::Buffer(
                params
                    .ok_or(ExecuteError::Internal(
                        "the params of a pass were not uploaded",
                    ))?
                    .clone(),
            ),
        })
    }
}

enum Bound {
    Buffer(wgpu::Buffer),
    View(wgpu::TextureView),
    Sampler(wgpu::Sampler),
}
