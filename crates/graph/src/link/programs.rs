//! Programs: their entry points, and the bindings that they need.

use super::pass::{LinkedBinding, LinkedProgram};
use super::scope::PassScope;
use super::{bindings, limits as device, params};
use crate::diagnostics::Reported;
use crate::errors::link::LinkError;
use crate::kinds::Program;
use crate::shader::{Global, Shader};
use naga::ShaderStage;
use wgt::BindingType as Type;

pub(super) fn link(
    program: &Program,
    stages: &[ShaderStage],
    depth_only: bool,
    scope: &mut PassScope<'_>,
) -> Reported<LinkedProgram> {
    let shader = match scope.shader(program) {
        Ok(shader) => shader,
        Err(reported) => {
            declared(program, scope);
            return Err(reported);
        }
    };
    let named = program.shader.as_ref().unwrap_or(&scope.pass);
    let wanted = named.span.clone();
    let mut entries = Vec::new();
    let mut wrong = None;
    for stage in stages {
        let name = match stage {
            ShaderStage::Vertex => &program.vertex,
            ShaderStage::Fragment => &program.fragment,
            _ => &program.compute,
        };
        match shader.entry(*stage, depth_only, name.as_ref(), &wanted) {
            Ok(entry) => entries.push(entry),
            Err(error) => wrong = Some(scope.report(error)),
        }
    }
    if let Some(reported) = wrong {
        return Err(reported);
    }
    let globals = shader.globals(&entries);
    bound_globals(program, &shader, &globals, scope)?;
    device::binding_numbers(&shader, &globals, scope)?;
    let mut linked = LinkedProgram {
        constants: params::constants(program, &shader, scope)?,
        bindings: Vec::with_capacity(globals.len()),
        shader,
        entries,
    };
    let mut wrong = None;
    for global in &globals {
        match bindings::bind(global, program, &linked, scope) {
            Ok(binding) => linked.bindings.push(binding),
            Err(reported) => wrong = Some(reported),
        }
    }
    counts(&linked.bindings, scope)?;
    let checked = device::footprints(&linked, scope);
    wrong.or(checked.err()).map_or(Ok(linked), Err)
}

/// Checks the types of the globals of a shader that is not valid: functions that use a global of
/// the wrong type are not valid for that reason alone.
fn declared(program: &Program, scope: &mut PassScope<'_>) {
    let Some(shader) = scope.declarations(program) else {
        return;
    };
    let globals = shader.globals(&[]);
    let linked = LinkedProgram {
        shader,
        entries: Vec::new(),
        constants: Vec::new(),
        bindings: Vec::new(),
    };
    for global in &globals {
        let mut bound = program.bind.iter();
        let is_bound = bound.any(|(name, _)| name.value == global.name);
        if is_bound || global.name == "params" || scope.is_known(&global.name) {
            // The pass is wrong anyway.
            let _ = bindings::bind(global, program, &linked, scope);
        }
    }
}

/// Checks that the entry binds only globals of its own shader. (A kind with several shaders
/// hands its bindings to all of them.)
fn bound_globals(
    program: &Program,
    shader: &Shader,
    globals: &[Global],
    scope: &mut PassScope<'_>,
) -> Reported<()> {
    let mut wrong = None;
    let own = scope.own_shader.as_ref();
    let is_own = program.shader.as_ref().map(|s| &s.value) == own.map(|s| &s.value);
    for (bound, _) in &program.bind {
        let exists = shader.global_names().any(|global| global == bound.as_str());
        if !exists && is_own {
            let names = globals.iter().map(|global| global.name.clone());
            wrong = Some(scope.report(LinkError::UnusedBind {
                shader: shader.source.file.name.to_string(),
                name: bound.clone(),
                globals: scope.symbols.reports.known(names),
            }));
        }
    }
    wrong.map_or(Ok(()), Err)
}

/// Returns the word for bindings of a type.
fn describe(ty: &Type) -> &'static str {
    match ty {
        Type::Buffer { ty, .. } if *ty == wgt::BufferBindingType::Uniform => "uniform buffers",
        Type::Buffer { .. } => "storage buffers",
        Type::StorageTexture { .. } => "storage textures",
        Type::Texture { .. } | Type::ExternalTexture => "textures",
        Type::Sampler(_) => "samplers",
        Type::AccelerationStructure { .. } => "acceleration structures",
    }
}

/// Checks the numbers of bindings that wgpu limits for each stage.
fn counts(bindings: &[LinkedBinding], scope: &mut PassScope<'_>) -> Reported<()> {
    const BOTH: &str = "buffers and acceleration structures";
    let limits = &scope.request().limits;
    #[rustfmt::skip] // A line each.
    let most = [
        ("storage buffers", limits.max_storage_buffers_per_shader_stage),
        ("uniform buffers", limits.max_uniform_buffers_per_shader_stage),
        ("textures", limits.max_sampled_textures_per_shader_stage),
        ("storage textures", limits.max_storage_textures_per_shader_stage),
        ("samplers", limits.max_samplers_per_shader_stage),
        ("acceleration structures", limits.max_acceleration_structures_per_shader_stage),
        (BOTH, limits.max_buffers_and_acceleration_structures_per_shader_stage),
    ];
    for (what, most) in most {
        let is_counted = |ty: &Type| match ty {
            Type::Buffer { .. } | Type::AccelerationStructure { .. } if what == BOTH => true,
            ty => describe(ty) == what,
        };
        let of_stage = |stage: wgt::ShaderStages| {
            let bindings = bindings.iter();
            let seen = bindings.filter(|bound| bound.visibility.contains(stage));
            seen.filter(|bound| is_counted(&bound.ty)).count()
        };
        let stages = [
            wgt::ShaderStages::VERTEX,
            wgt::ShaderStages::FRAGMENT,
            wgt::ShaderStages::COMPUTE,
        ];
        let number = stages.map(of_stage).into_iter().max().unwrap_or(0);
        if number > most as usize {
            let pass = scope.pass.clone();
            scope.unsupported(LinkError::TooManyBindings(pass, what, number, most))?;
        }
    }
    Ok(())
}
