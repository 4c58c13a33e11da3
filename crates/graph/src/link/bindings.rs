//! Which resource a shader's global is, and whether it can be.

use super::{
    linker::{Linker, access},
    pass::{Access, BindTarget, Block, LinkedBinding, LinkedPass, LinkedProgram, Usage},
};
use crate::{
    diagnostics::reports::ErrorGuaranteed,
    document::materials::Filter,
    errors::{instantiate::InterfaceError, link::LinkError},
    kinds::step::Program,
    language::name::wgsl_identifier,
    provider::ProvidedBinding,
    resource::{CLOCK_BYTES, FRAME_BYTES, ResourceKind, Sampler, SubresourceRange, Target},
    shader::{
        class::{Class, Member, TextureClass},
        reflect::Global,
    },
};
use std::num::NonZeroU64;

/// Target and type of a binding, and the usage that its resource must allow.
type Binding = (BindTarget, wgt::BindingType, Usage);

impl Linker<'_, '_> {
    pub(super) fn bind(
        &mut self,
        global: &Global,
        program: &Program,
        linked: &LinkedProgram,
        pass: &mut LinkedPass,
    ) -> Result<LinkedBinding, ErrorGuaranteed> {
        let bound = program
            .bind
            .iter()
            .find(|(name, _)| name.value == global.name);
        let (target, ty) = match (&global.class, bound) {
            (Class::Unsupported(what), _) => {
                return Err(self.report(LinkError::Unsupported {
                    global: global.name.clone(),
                    what,
                    span: global.span.clone(),
                }));
            }
            (Class::Uniform { size, members, .. }, None) if global.name == "params" => {
                let block = self.params_uniform(global, *size, members)?;
                (BindTarget::Params(block), uniform(*size))
            }
            (_, bound) => {
                let mut target = match bound {
                    Some((_, operand)) => self.operand(operand, &pass.name)?.0,
                    None => self.target(global, pass)?,
                };
                let (bound, ty, usage) =
                    self.binding(global, &mut target, (linked, program), pass)?;
                if global.writes {
                    self.writable(target.id, &global.span)?;
                    self.stage_may_write(global)?;
                }
                let used = (global.reads, global.writes, false);
                let is_frame = self.symbols.get(target.id).kind == ResourceKind::Frame;
                pass.accesses.push(Access {
                    triggers: !is_frame || reads_clock(linked, global),
                    ..access(&target, used, usage, &global.span)
                });
                (bound, ty)
            }
        };
        Ok(LinkedBinding {
            group: global.group,
            binding: global.binding,
            target,
            ty,
            visibility: global.stages,
        })
    }

    /// Vertex shaders write nothing on most devices.
    fn stage_may_write(&mut self, global: &Global) -> Result<(), ErrorGuaranteed> {
        let needed = wgt::Features::VERTEX_WRITABLE_STORAGE;
        let has = self.symbols.request.features.contains(needed);
        if global.stages.contains(wgt::ShaderStages::VERTEX) && !has {
            self.reports.unsupported(LinkError::VertexWrites {
                global: global.name.clone(),
                span: global.span.clone(),
            })
        } else {
            Ok(())
        }
    }

    /// Not every device queries rays.
    fn ray_query(&mut self, global: &Global, pass: &LinkedPass) -> Result<(), ErrorGuaranteed> {
        let needed = wgt::Features::EXPERIMENTAL_RAY_QUERY;
        if self.symbols.request.features.contains(needed) {
            Ok(())
        } else {
            self.reports.unsupported(LinkError::RayQuery {
                pass: pass.name.clone(),
                span: global.span.clone(),
            })
        }
    }

    /// The pass's params as the shader's struct wants them.
    fn params_uniform(
        &mut self,
        global: &Global,
        size: u64,
        members: &[Member],
    ) -> Result<Block, ErrorGuaranteed> {
        let most = self.symbols.request.limits.max_uniform_buffer_binding_size;
        let what = if members.is_empty() {
            "is not a struct"
        } else if size > most {
            "is too large for the adapter"
        } else {
            return self.params_block(global, size, members);
        };
        Err(self.report(LinkError::ParamsUniform {
            what,
            size,
            span: global.span.clone(),
        }))
    }

    /// Finds the target of a global: bound by a group, else of that name.
    fn target(&mut self, global: &Global, pass: &LinkedPass) -> Result<Target, ErrorGuaranteed> {
        let mut said = self.pass.inherited_bind.iter();
        if let Some(&said) = said.find(|said| said.name.value == global.name) {
            return self
                .symbols
                .resolve(said.value, said.position, self.reports);
        }
        let position = self.pass.position.unwrap_or_else(|| self.symbols.root());
        if let Some(found) = self
            .symbols
            .find_global(&global.name, position.scope, self.reports)
        {
            return found;
        }
        if let Some(reported) = self.symbols.scopes.document(position.scope).incomplete {
            return Err(reported);
        }
        if let Some(name) = global.name.strip_suffix("_previous")
            && let Some(base) = self.symbols.find_global(name, position.scope, self.reports)
            && let Some(kept) = self.symbols.kept(base?.id)
        {
            return Err(self.reports.report(InterfaceError::NoPrevious {
                name: global.name.clone(),
                span: global.span.clone(),
                what: "kept".to_owned(),
                kept: Some(kept),
            }));
        }
        let known = self.symbols.known(position.scope);
        let known = known.iter().map(|name| wgsl_identifier(name));
        let known = self.reports.known(known);
        Err(self.report(LinkError::UnknownGlobal {
            global: global.name.clone(),
            span: global.span.clone(),
            pass: pass.name.clone(),
            known,
        }))
    }

    fn binding(
        &mut self,
        global: &Global,
        target: &mut Target,
        (linked, program): (&LinkedProgram, &Program),
        pass: &LinkedPass,
    ) -> Result<Binding, ErrorGuaranteed> {
        let resource = self.symbols.get(target.id).clone();
        let needed = match (&global.class, &resource.kind) {
            (Class::Uniform { size, .. }, ResourceKind::Frame) => {
                return self.uniform_buffer(global, target, *size, FRAME_BYTES);
            }
            (Class::Uniform { size, .. }, ResourceKind::Provided(provided))
                if provided.binding != ProvidedBinding::Storage =>
            {
                return self.uniform_buffer(global, target, *size, provided.stride);
            }
            (Class::Uniform { size, .. }, ResourceKind::Buffer(_)) => {
                let id = self.symbols.base(target.id);
                self.layouts.see(id, &target.part, global);
                return self.uniform_buffer(global, target, *size, u64::MAX);
            }
            (
                Class::Storage {
                    fixed,
                    stride,
                    read_only,
                    ..
                },
                ResourceKind::Buffer(_) | ResourceKind::Provided(_),
            ) if self.may_be_storage(target.id) => {
                let least = fixed + stride.unwrap_or(0);
                return self.storage_buffer(global, target, least, *read_only);
            }
            (Class::Texture(class), ResourceKind::Texture(texture)) => {
                let (ty, usage, aspect) =
                    self.texture(global, class, (texture, target), (linked, program))?;
                target.part.aspect = aspect;
                let (TextureClass::Sampled { dimension, .. }
                | TextureClass::Storage { dimension, .. }) = *class;
                let bound = BindTarget::Texture {
                    target: target.clone(),
                    dimension,
                };
                return Ok((bound, ty, Usage::Texture(usage)));
            }
            (Class::Sampler { comparison }, ResourceKind::Sampler(sampler)) => {
                match sampler_type(*comparison, sampler) {
                    Ok(ty) => {
                        let ty = wgt::BindingType::Sampler(ty);
                        return Ok((BindTarget::Sampler(target.id), ty, Usage::None));
                    }
                    Err(needed) => needed,
                }
            }
            (Class::AccelerationStructure, ResourceKind::AccelerationStructure) => {
                self.ray_query(global, pass)?;
                let ty = wgt::BindingType::AccelerationStructure {
                    vertex_return: false,
                };
                let bound = BindTarget::AccelerationStructure(target.id);
                return Ok((bound, ty, Usage::None));
            }
            (Class::AccelerationStructure, _) => "an acceleration structure",
            (Class::Uniform { .. }, _) => "a uniform buffer",
            (Class::Storage { .. }, _) => "a storage buffer",
            (Class::Texture(_), _) => "a texture",
            _ => "a sampler",
        };
        Err(self.report(LinkError::WrongKind {
            global: global.name.clone(),
            span: global.span.clone(),
            needed,
            name: resource.name,
            found: resource.kind.describe(),
            declared: resource.declared,
        }))
    }

    fn may_be_storage(&self, id: crate::resource::ResourceId) -> bool {
        match &self.symbols.get(id).kind {
            ResourceKind::Provided(provided) => provided.binding != ProvidedBinding::Uniform,
            _ => true,
        }
    }

    /// A uniform of `size` bytes in the shader, where `have` are there.
    fn uniform_buffer(
        &mut self,
        global: &Global,
        target: &Target,
        size: u64,
        have: u64,
    ) -> Result<Binding, ErrorGuaranteed> {
        let most = self.symbols.request.limits.max_uniform_buffer_binding_size;
        if size > have {
            return Err(self.report(LinkError::UniformSize {
                name: self.symbols.get(target.id).name.clone(),
                have,
                size,
                span: global.span.clone(),
            }));
        }
        if size > most {
            self.reports.unsupported(LinkError::UniformLimit {
                global: global.name.clone(),
                size,
                most,
                span: global.span.clone(),
            })?;
        }
        self.aligned(global, target)?;
        Ok((
            BindTarget::Buffer(target.clone()),
            uniform(size),
            Usage::Buffer(wgt::BufferUsages::UNIFORM),
        ))
    }

    /// Items of a provided buffer begin where the device can bind; those of the document's own are
    /// looked at when their layout is known.
    fn aligned(&mut self, global: &Global, target: &Target) -> Result<(), ErrorGuaranteed> {
        let ResourceKind::Provided(provided) = &self.symbols.get(target.id).kind else {
            return Ok(());
        };
        let alignment = u64::from(
            self.symbols
                .request
                .limits
                .min_uniform_buffer_offset_alignment,
        );
        if target.part == SubresourceRange::WHOLE || provided.stride % alignment == 0 {
            return Ok(());
        }
        let (name, stride) = (self.symbols.get(target.id).name.clone(), provided.stride);
        self.reports.unsupported(LinkError::Alignment {
            name,
            stride,
            alignment,
            span: global.span.clone(),
        })
    }

    /// A storage buffer of which the shader needs `least` bytes.
    fn storage_buffer(
        &mut self,
        global: &Global,
        target: &Target,
        least: u64,
        read_only: bool,
    ) -> Result<Binding, ErrorGuaranteed> {
        let resource = self.symbols.get(target.id);
        if matches!(resource.kind, ResourceKind::Provided(_)) && !read_only {
            let name = resource.name.clone();
            return Err(self.report(LinkError::WritesProvided {
                name,
                span: global.span.clone(),
            }));
        }
        self.aligned(global, target)?;
        let id = self.symbols.base(target.id);
        self.layouts.see(id, &target.part, global);
        Ok((
            BindTarget::Buffer(target.clone()),
            wgt::BindingType::Buffer {
                ty: wgt::BufferBindingType::Storage { read_only },
                has_dynamic_offset: false,
                min_binding_size: NonZeroU64::new(least),
            },
            Usage::Buffer(wgt::BufferUsages::STORAGE),
        ))
    }
}

/// True if a program reads number or time of the uniform `frame`, which differ in every frame.
fn reads_clock(linked: &LinkedProgram, global: &Global) -> bool {
    let mut entries = linked.entries.iter();
    entries.any(|entry| {
        linked
            .shader
            .reads_below(*entry, global.handle, CLOCK_BYTES)
    })
}

/// How a sampler is bound, or what the shader needs instead.
fn sampler_type(
    comparison: bool,
    sampler: &Sampler,
) -> Result<wgt::SamplerBindingType, &'static str> {
    match (comparison, sampler.compare.is_some(), sampler.filter) {
        (true, true, _) => Ok(wgt::SamplerBindingType::Comparison),
        (false, false, Filter::Linear) => Ok(wgt::SamplerBindingType::Filtering),
        (false, false, Filter::Nearest) => Ok(wgt::SamplerBindingType::NonFiltering),
        (true, false, _) => Err("a sampler with `compare`"),
        (false, true, _) => Err("a sampler without `compare`"),
    }
}

fn uniform(size: u64) -> wgt::BindingType {
    wgt::BindingType::Buffer {
        ty: wgt::BufferBindingType::Uniform,
        has_dynamic_offset: false,
        min_binding_size: NonZeroU64::new(size),
    }
}
