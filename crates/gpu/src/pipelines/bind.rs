//! Binds pipelines to memory: bind groups, attachments, and operands of copies.

use super::handles::{GpuAttachment, GpuOperand, GpuProgram, Handles, NamedWork};
use super::pipelines::Pipeline;
use crate::buffer;
use crate::error::{ExecuteError, named, scoped};
use crate::memory::allocation::extent;
use crate::memory::memory::InFrame;
use skiagraph_graph::{
    Attachment, BindTarget, Ids, LinkedPass, LinkedProgram, ResourceKind, SubresourceRange, Target,
    step::{
        ColorTarget, CpuCall, CpuItems, DepthTarget, Dispatch, Draw, Groups, StencilTarget, Step,
    },
};

/// Creates the uniform buffer of the `params` of a pass's step; `None` if its shader has none.
pub(crate) fn upload(
    device: &wgpu::Device,
    pass: &LinkedPass,
    step: &Step<Ids>,
) -> Result<Option<wgpu::Buffer>, ExecuteError> {
    let Some(bytes) = step.program().and_then(LinkedProgram::params) else {
        return Ok(None);
    };
    let label = format!("{} params", *pass.name);
    let failed = "the params of a pass could not be uploaded";
    let usage = wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST;
    let fill = || buffer::filled(device, &label, bytes, usage, failed).map(Some);
    scoped(device, &pass.name, fill).map_err(|error| named(error, pass))?
}

/// Binds steps to memory, for one state of the ping-pong.
pub(crate) struct Binder<'a> {
    pub device: &'a wgpu::Device,
    pub frame: InFrame<'a>,
    /// Attachments that are not stored.
    pub discarded: &'a [Target],
}

impl Binder<'_> {
    pub fn step(
        &self,
        label: &str,
        step: &Step<Ids>,
        pipeline: Option<&Pipeline>,
        params: Option<&wgpu::Buffer>,
    ) -> Result<Step<Handles>, ExecuteError> {
        let program = |program: &LinkedProgram| {
            let missing = ExecuteError::Internal("a draw or dispatch has no pipeline");
            let pipeline = pipeline.ok_or(missing)?;
            Ok::<_, ExecuteError>(GpuProgram {
                pipeline: pipeline.kind.clone(),
                groups: self.groups(label, program, &pipeline.layouts, params)?,
            })
        };
        Ok(match step {
            Step::Draw(draw) => Step::Draw(self.draw(draw, program(&draw.program)?)?),
            Step::Dispatch(dispatch) => Step::Dispatch(Dispatch {
                program: program(&dispatch.program)?,
                groups: match &dispatch.groups {
                    Groups::Direct(groups) => Groups::Direct(*groups),
                    Groups::Indirect(target) => Groups::Indirect(self.arguments(target)?),
                },
            }),
            Step::Copy { from, to } => Step::Copy {
                from: self.operand(from, false)?,
                to: self.operand(to, false)?,
            },
            Step::Clear { target, value } => Step::Clear {
                target: self.operand(target, true)?,
                value: *value,
            },
            Step::Cpu(call) => Step::Cpu(self.cpu_call(call)?),
        })
    }

    fn cpu_call(&self, call: &CpuCall<Ids>) -> Result<CpuCall<Handles>, ExecuteError> {
        // A provider's buffer may lack the usage.
        let read = |target: &Target| {
            let operand = self.operand(target, false)?;
            match &operand {
                GpuOperand::Buffer { buffer, .. }
                    if !buffer.usage().contains(wgpu::BufferUsages::COPY_SRC) =>
                {
                    Err(ExecuteError::NotReadable {
                        name: self.frame.plan.resource(target.id).name.clone(),
                        usage: "BufferUsages::COPY_SRC",
                    })
                }
                _ => Ok(operand),
            }
        };
        let reads = call.reads.iter().map(|items| {
            Ok(CpuItems {
                buffer: read(&items.buffer)?,
                bytes: items.bytes,
            })
        });
        Ok(CpuCall {
            work: NamedWork {
                name: self.frame.plan.resource(call.work).name.clone(),
                work: self.frame.memory.cpu_work(call.work)?.clone(),
            },
            entry: call.entry.clone(),
            count: read(&call.count)?,
            reads: reads.collect::<Result<_, ExecuteError>>()?,
            writes: CpuItems {
                buffer: self.operand(&call.writes.buffer, false)?,
                bytes: call.writes.bytes,
            },
        })
    }

    /// Returns a view of each mip of each layer of a part.
    pub fn single_views(&self, target: &Target) -> Result<Vec<GpuAttachment>, ExecuteError> {
        let id = target.id;
        let ResourceKind::Texture(texture) = &self.frame.plan.resource(id).kind else {
            return Err(ExecuteError::Internal("only textures have views"));
        };
        let mut views = Vec::new();
        for mip in target.part.mips.clone() {
            let layers = target.part.layers.clone();
            for layer in layers.take_while(|layer| *layer < texture.mip_layers(mip)) {
                let part = SubresourceRange {
                    mips: mip..mip + 1,
                    layers: layer..layer + 1,
                    aspect: wgpu::TextureAspect::All,
                };
                views.push(self.attachment(&Target { id, part })?);
            }
        }
        Ok(views)
    }

    fn attachment(&self, target: &Target) -> Result<GpuAttachment, ExecuteError> {
        let is_3d = matches!(
            &self.frame.plan.resource(target.id).kind,
            ResourceKind::Texture(texture) if texture.is_3d
        );
        let dimension = if is_3d {
            wgpu::TextureViewDimension::D3
        } else {
            wgpu::TextureViewDimension::D2
        };
        // An attachment has all aspects of its texture.
        let mut whole = target.clone();
        whole.part.aspect = wgpu::TextureAspect::All;
        Ok(GpuAttachment {
            view: self.frame.view(&whole, dimension)?,
            slice: is_3d.then_some(target.part.layers.start),
            store: match self.discarded.contains(target) {
                true => wgpu::StoreOp::Discard,
                false => wgpu::StoreOp::Store,
            },
        })
    }

    fn arguments(&self, target: &Target) -> Result<(wgpu::Buffer, u64), ExecuteError> {
        let (buffer, range) = self.frame.bytes(target)?;
        Ok((buffer.clone(), range.start))
    }

    fn operand(&self, target: &Target, is_cleared: bool) -> Result<GpuOperand, ExecuteError> {
        let resource = self.frame.plan.resource(target.id);
        let ResourceKind::Texture(texture) = &resource.kind else {
            let (buffer, range) = self.frame.bytes(target)?;
            let buffer = buffer.clone();
            return Ok(GpuOperand::Buffer { buffer, range });
        };
        let layers = target.part.layers.len() as u32;
        let mips = target.part.mips.clone();
        let mips = mips.map(|mip| extent(texture, mip, layers.min(texture.mip_layers(mip))));
        Ok(GpuOperand::Texture {
            texture: self.frame.texture(target.id)?.clone(),
            part: target.part.clone(),
            mips: mips.collect(),
            views: if is_cleared {
                self.single_views(target)?
            } else {
                Vec::new()
            },
        })
    }

    fn draw(&self, draw: &Draw<Ids>, program: GpuProgram) -> Result<Draw<Handles>, ExecuteError> {
        let attachment = |attachment: &Attachment| self.attachment(&attachment.target);
        let color = |color: &Option<ColorTarget<Ids>>| {
            let Some(color) = color else {
                return Ok(None);
            };
            Ok(Some(ColorTarget {
                target: attachment(&color.target)?,
                resolve: color.resolve.as_ref().map(attachment).transpose()?,
                clear: color.clear,
                blend: color.blend,
                blend_constant: color.blend_constant,
                write: color.write,
            }))
        };
        let depth = |depth: &DepthTarget<Ids>| {
            Ok::<_, ExecuteError>(DepthTarget {
                target: attachment(&depth.target)?,
                clear: depth.clear,
                compare: depth.compare,
                write: depth.write,
                bias: depth.bias,
            })
        };
        let stencil = |stencil: &StencilTarget<Ids>| {
            Ok::<_, ExecuteError>(StencilTarget {
                target: attachment(&stencil.target)?,
                clear: stencil.clear,
                state: stencil.state.clone(),
                reference: stencil.reference,
            })
        };
        let colors = draw.colors.iter().map(color);
        Ok(Draw {
            program,
            fullscreen: draw.fullscreen,
            colors: colors.collect::<Result<_, ExecuteError>>()?,
            depth: draw.depth.as_ref().map(depth).transpose()?,
            stencil: draw.stencil.as_ref().map(stencil).transpose()?,
            canvas: draw.canvas.as_ref().map(attachment).transpose()?,
            area: draw.area,
            call: draw.call.in_stage(|target| self.arguments(target))?,
            primitive: draw.primitive,
        })
    }

    /// The bind groups of a program, one for each of the layouts.
    fn groups(
        &self,
        label: &str,
        program: &LinkedProgram,
        layouts: &[Option<wgpu::BindGroupLayout>],
        params: Option<&wgpu::Buffer>,
    ) -> Result<Vec<(u32, wgpu::BindGroup)>, ExecuteError> {
        let mut groups = Vec::new();
        for (group, layout) in (0u32..).zip(layouts) {
            let Some(layout) = layout else {
                continue;
            };
            let bindings = program.bindings.iter();
            let bindings = bindings.filter(|binding| binding.group == group);
            let textures = bindings.clone();
            let views = textures.map(|binding| self.bound_view(&binding.target));
            let views: Vec<Option<wgpu::TextureView>> = views.collect::<Result<_, _>>()?;
            let entries = bindings.zip(&views).map(|(bound, view)| {
                Ok(wgpu::BindGroupEntry {
                    binding: bound.binding,
                    resource: self.resource(&bound.target, view.as_ref(), params)?,
                })
            });
            let entries: Vec<_> = entries.collect::<Result<_, ExecuteError>>()?;
            let made = self.device.create_bind_group(&wgpu::BindGroupDescriptor {
                label: Some(label),
                layout,
                entries: &entries,
            });
            groups.push((group, made));
        }
        Ok(groups)
    }

    /// Returns the view of a texture that a shader binds; `None` for other resources.
    fn bound_view(&self, target: &BindTarget) -> Result<Option<wgpu::TextureView>, ExecuteError> {
        match target {
            BindTarget::Texture { target, dimension } => {
                self.frame.view(target, *dimension).map(Some)
            }
            _ => Ok(None),
        }
    }

    /// Returns a resource as a shader binds it, a texture by its view.
    fn resource<'r>(
        &'r self,
        target: &BindTarget,
        view: Option<&'r wgpu::TextureView>,
        params: Option<&'r wgpu::Buffer>,
    ) -> Result<wgpu::BindingResource<'r>, ExecuteError> {
        let memory = self.frame.memory;
        Ok(match target {
            BindTarget::Buffer(target) => {
                let (buffer, range) = self.frame.bytes(target)?;
                let size = std::num::NonZeroU64::new(range.end - range.start);
                wgpu::BindingResource::Buffer(wgpu::BufferBinding {
                    buffer,
                    offset: range.start,
                    size: size.filter(|size| size.get() < buffer.size()),
                })
            }
            BindTarget::Texture { .. } => {
                let missing = ExecuteError::Internal("a bound texture has no view");
                wgpu::BindingResource::TextureView(view.ok_or(missing)?)
            }
            BindTarget::Sampler(id) => wgpu::BindingResource::Sampler(memory.sampler(*id)?),
            BindTarget::AccelerationStructure(id) => {
                memory.acceleration_structure(*id)?.as_binding()
            }
            BindTarget::Params(_) => {
                let missing = ExecuteError::Internal("the params of a pass were not uploaded");
                params.ok_or(missing)?.as_entire_binding()
            }
        })
    }
}
