//! Bindings: finds the resource for each global of a shader, and checks that it fits.

use super::pass::{BindTarget, LinkedBinding, LinkedProgram, Usage};
use super::scope::PassScope;
use super::{params, textures};
use crate::diagnostics::Reported;
use crate::document::Filter;
use crate::errors::link::LinkError;
use crate::kinds::Program;
use crate::provider::ProvidedBinding;
use crate::resource::{CLOCK_BYTES, FRAME_BYTES, ResourceKind, Sampler, SubresourceRange, Target};
use crate::shader::members::reads_below;
use crate::shader::{Class, Global};
use std::num::NonZeroU64;
use wgt::BufferBindingType::{Storage, Uniform};

/// Target and type of a binding, and the usage that its resource must allow.
type Binding = (BindTarget, wgt::BindingType, Usage);

pub(super) fn bind(
    global: &Global,
    program: &Program,
    linked: &LinkedProgram,
    scope: &mut PassScope<'_>,
) -> Reported<LinkedBinding> {
    let features = scope.request().features;
    let mut bind = program.bind.iter();
    let bound = bind.find(|(name, _)| name.value == global.name);
    let (target, ty) = match (&global.class, bound) {
        (Class::Unsupported(what), _) => {
            return Err(scope.report(LinkError::Unsupported(global.located(), what)));
        }
        (Class::Uniform { size, members, .. }, None) if global.name == "params" => {
            let block = params::block(global, *size, members, scope)?;
            (BindTarget::Params(block), buffer(Uniform, *size))
        }
        (_, bound) => {
            let mut target = match bound {
                Some((_, operand)) => scope.operand(operand)?.0,
                None => scope.target(global)?,
            };
            let (bound, ty, usage) = binding(global, &mut target, (linked, program), scope)?;
            if global.writes {
                scope.writable(target.id, &global.span)?;
                // Vertex shaders write nothing on most devices.
                if global.stages.contains(wgt::ShaderStages::VERTEX)
                    && !features.contains(wgt::Features::VERTEX_WRITABLE_STORAGE)
                {
                    scope.unsupported(LinkError::VertexWrites(global.located()))?;
                }
            }
            let used = (global.reads, global.writes, false);
            let is_frame = scope.get(target.id).kind == ResourceKind::Frame;
            scope.access(&target, used, usage, &global.span);
            if let Some(access) = scope.accesses.last_mut() {
                access.triggers = !is_frame || reads_clock(linked, global);
            }
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

fn binding(
    global: &Global,
    target: &mut Target,
    (linked, program): (&LinkedProgram, &Program),
    scope: &mut PassScope<'_>,
) -> Reported<Binding> {
    let features = scope.request().features;
    let resource = scope.get(target.id).clone();
    let needed = match (&global.class, &resource.kind) {
        (Class::Uniform { size, .. }, ResourceKind::Frame) => {
            return uniform_buffer(global, target, *size, FRAME_BYTES, scope);
        }
        (Class::Uniform { size, .. }, ResourceKind::Provided(provided))
            if provided.binding != ProvidedBinding::Storage =>
        {
            return uniform_buffer(global, target, *size, provided.stride, scope);
        }
        (Class::Uniform { size, .. }, ResourceKind::Buffer(_)) => {
            let id = scope.symbols.base(target.id);
            scope.layouts.see(id, &target.part, global);
            return uniform_buffer(global, target, *size, u64::MAX, scope);
        }
        (
            Class::Storage {
                fixed,
                stride,
                read_only,
                ..
            },
            ResourceKind::Buffer(_) | ResourceKind::Provided(_),
        ) if !matches!(&resource.kind,
            ResourceKind::Provided(it) if it.binding == ProvidedBinding::Uniform) =>
        {
            let least = fixed + stride.unwrap_or(0);
            return storage_buffer(global, target, least, *read_only, scope);
        }
        (Class::Texture(dimension, class), ResourceKind::Texture(texture)) => {
            let (ty, usage, aspect) = textures::texture(
                global,
                (*dimension, class),
                (texture, target),
                (linked, program),
                scope,
            )?;
            target.part.aspect = aspect;
            let (target, dimension) = (target.clone(), *dimension);
            let bound = BindTarget::Texture { target, dimension };
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
            // Not every device queries rays.
            if !features.contains(wgt::Features::EXPERIMENTAL_RAY_QUERY) {
                scope.unsupported(LinkError::RayQuery(scope.pass.clone(), global.span.clone()))?;
            }
            let ty = wgt::BindingType::AccelerationStructure {
                vertex_return: false,
            };
            let bound = BindTarget::AccelerationStructure(target.id);
            return Ok((bound, ty, Usage::None));
        }
        (Class::AccelerationStructure, _) => "an acceleration structure",
        (Class::Uniform { .. }, _) => "a uniform buffer",
        (Class::Storage { .. }, _) => "a storage buffer",
        (Class::Texture(..), _) => "a texture",
        _ => "a sampler",
    };
    Err(scope.report(LinkError::WrongKind {
        global: global.located(),
        needed,
        name: resource.name,
        kind: resource.kind.describe(),
        declared: resource.declared,
    }))
}

/// Checks that a uniform of `size` bytes in the shader fits into a buffer of `have` bytes, and
/// returns the binding.
fn uniform_buffer(
    global: &Global,
    target: &Target,
    size: u64,
    have: u64,
    scope: &mut PassScope<'_>,
) -> Reported<Binding> {
    let most = scope.request().limits.max_uniform_buffer_binding_size;
    if size > have {
        return Err(scope.report(LinkError::UniformSize {
            name: scope.get(target.id).name.clone(),
            have,
            size,
            span: global.span.clone(),
        }));
    }
    if size > most {
        let global = global.located();
        scope.unsupported(LinkError::UniformLimit { global, size, most })?;
    }
    let alignment = scope.request().limits.min_uniform_buffer_offset_alignment;
    aligned(global, target, alignment, scope)?;
    Ok((
        BindTarget::Buffer(target.clone()),
        buffer(Uniform, size),
        Usage::Buffer(wgt::BufferUsages::UNIFORM),
    ))
}

/// Checks that items of a provided buffer begin at offsets that the device can bind. Those of the
/// document's buffers are checked when their layout is known.
fn aligned(
    global: &Global,
    target: &Target,
    alignment: u32,
    scope: &mut PassScope<'_>,
) -> Reported<()> {
    let ResourceKind::Provided(provided) = &scope.get(target.id).kind else {
        return Ok(());
    };
    let alignment = u64::from(alignment);
    if target.part == SubresourceRange::WHOLE || provided.stride % alignment == 0 {
        return Ok(());
    }
    let (name, stride) = (scope.get(target.id).name.clone(), provided.stride);
    scope.unsupported(LinkError::Alignment {
        name,
        stride,
        alignment,
        span: global.span.clone(),
    })
}

/// Returns the binding of a storage buffer of which the shader needs `least` bytes.
fn storage_buffer(
    global: &Global,
    target: &Target,
    least: u64,
    read_only: bool,
    scope: &mut PassScope<'_>,
) -> Reported<Binding> {
    let resource = scope.get(target.id);
    if matches!(resource.kind, ResourceKind::Provided(_)) && !read_only {
        let name = resource.name.clone();
        return Err(scope.report(LinkError::WritesProvided(name, global.span.clone())));
    }
    let alignment = scope.request().limits.min_storage_buffer_offset_alignment;
    aligned(global, target, alignment, scope)?;
    let id = scope.symbols.base(target.id);
    scope.layouts.see(id, &target.part, global);
    Ok((
        BindTarget::Buffer(target.clone()),
        buffer(Storage { read_only }, least),
        Usage::Buffer(wgt::BufferUsages::STORAGE),
    ))
}

/// True if a program reads index or seconds of the uniform `frame`, which differ in every frame.
fn reads_clock(linked: &LinkedProgram, global: &Global) -> bool {
    let mut entries = linked.entries.iter();
    entries.any(|entry| reads_below(&linked.shader, *entry, global.handle, CLOCK_BYTES))
}

/// Returns the type of a sampler's binding, or as the error the sort of sampler that the shader
/// needs.
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

/// Returns the type of a binding of a buffer of `least` bytes at least.
pub(super) fn buffer(ty: wgt::BufferBindingType, least: u64) -> wgt::BindingType {
    wgt::BindingType::Buffer {
        ty,
        has_dynamic_offset: false,
        min_binding_size: NonZeroU64::new(least),
    }
}
