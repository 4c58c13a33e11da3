//! Limits of a device on shaders, besides those on bindings: memory of workgroups and threads,
//! values between stages, numbers of locations and bindings.

use super::{pass::LinkedProgram, scope::PassScope};
use crate::diagnostics::Reported;
use crate::errors::limits::{Entry, Excess, LimitError};
use crate::errors::link::LinkError;
use crate::kinds::{Draw, Names};
use crate::shader::{Footprint, Global, Memory, Shader, Varying, Varyings};
use naga::ShaderStage;

/// Greatest size in bytes of the private variables of an entry point, and of the variables of one
/// function: the size that WGSL guarantees (its chapter of limits). Adapters do not tell how much
/// they have.
const MOST_OF_ONE: u64 = 8192;

/// Greatest size in bytes of the variables of all functions that an entry point runs. Drivers
/// inline functions, so that all variables stand on one stack; that of a software adapter is a
/// thread's stack, once for each lane.
const MOST_OF_ALL: u64 = 65_536;

/// Greatest size in bytes of a value: the longest array that WGSL allows, 2,047 vectors of four. A
/// value that is indexed is stored like a variable.
const MOST_OF_A_VALUE: u64 = 2048 * 16;

/// Checks the memory that each entry point of a program takes.
pub(super) fn footprints(program: &LinkedProgram, scope: &mut PassScope<'_>) -> Reported<()> {
    let mut wrong = None;
    for &index in &program.entries {
        let shader = &program.shader;
        let checked = match shader.footprint(index, &program.constants) {
            Ok(footprint) => check_footprint(&entry(shader, index), &footprint, scope),
            Err(error) => Err(scope.report(error)),
        };
        wrong = checked.err().or(wrong);
    }
    wrong.map_or(Ok(()), Err)
}

fn check_footprint(
    entry: &Entry,
    footprint: &Footprint,
    scope: &mut PassScope<'_>,
) -> Reported<()> {
    let most = scope.request().limits.max_compute_workgroup_storage_size;
    if let Some(excess) = beyond(&footprint.workgroup, u64::from(most), entry) {
        let entry = entry.clone();
        scope.unsupported(LimitError::Workgroup(entry, excess))?;
    }
    if let Some(excess) = beyond(&footprint.private, MOST_OF_ONE, entry) {
        let entry = entry.clone();
        return Err(scope.report(LimitError::Private(entry, excess)));
    }
    for (function, memory) in &footprint.functions {
        if let Some(excess) = beyond(memory, MOST_OF_ONE, entry) {
            return Err(scope.report(LimitError::Function {
                file: entry.file.clone(),
                function: function.clone(),
                excess,
            }));
        }
    }
    let bytes = footprint.functions.iter().map(|(_, memory)| memory.bytes);
    let bytes = bytes.fold(0, u64::saturating_add);
    let largest = footprint.functions.iter().map(|(_, memory)| memory);
    if let Some(largest) = largest.max_by_key(|memory| memory.bytes)
        && bytes > MOST_OF_ALL
    {
        let (of_largest, largest) = largest.largest(&entry.span);
        let excess = Excess {
            bytes,
            most: MOST_OF_ALL,
            of_largest,
            largest,
        };
        let entry = entry.clone();
        return Err(scope.report(LimitError::Functions(entry, excess)));
    }
    if let Some(Excess { bytes, largest, .. }) = beyond(&footprint.value, MOST_OF_A_VALUE, entry) {
        return Err(scope.report(LimitError::Value {
            file: entry.file.clone(),
            function: largest,
            bytes,
            most: MOST_OF_A_VALUE,
        }));
    }
    Ok(())
}

/// Checks that the adapter has the numbers of groups and bindings that a shader uses.
pub(super) fn binding_numbers(
    shader: &Shader,
    globals: &[Global],
    scope: &mut PassScope<'_>,
) -> Reported<()> {
    let limits = &scope.request().limits;
    // Those of globals that nothing uses count, too: a device refuses the whole module. (One number
    // for two globals is found when the shader is validated.)
    let groups = shader.groups();
    for (global, group, span) in groups.filter(|(_, group, _)| *group >= limits.max_bind_groups) {
        scope.unsupported(LinkError::BindGroup {
            global: global.to_owned(),
            group,
            most: limits.max_bind_groups,
            span,
        })?;
    }
    let most = limits.max_bindings_per_bind_group;
    for global in globals.iter().filter(|global| global.binding >= most) {
        scope.unsupported(LimitError::BindingNumber {
            file: shader.file().to_owned(),
            global: global.name.clone(),
            binding: global.binding,
            most,
            span: global.span.clone(),
        })?;
    }
    Ok(())
}

/// Checks that the values between a draw's stages fit together and into the adapter.
pub(super) fn stages(
    program: &LinkedProgram,
    draw: &Draw<Names>,
    scope: &mut PassScope<'_>,
) -> Reported<()> {
    let shader = &program.shader;
    let limits = &scope.request().limits;
    let most = limits.max_inter_stage_shader_variables;
    let vertex = program.entry(ShaderStage::Vertex);
    if let Some(index) = vertex {
        let is_points = draw.primitive.topology == wgt::PrimitiveTopology::PointList;
        let at = entry(shader, index);
        if let Some(attribute) = Varyings::inputs(shader.module(), index).locations.first() {
            return Err(scope.report(LimitError::Attribute(at, attribute.location)));
        }
        let outputs = Varyings::outputs(shader.module(), index);
        let locations = most.saturating_sub(outputs.builtins);
        check_locations(&at, "writes", &outputs, locations, scope)?;
        let builtins = outputs.builtins + u32::from(is_points);
        check_varyings(&at, "writes", &outputs, builtins, most, scope)?;
    }
    let Some(fragment) = program.entry(ShaderStage::Fragment) else {
        return Ok(());
    };
    let at = entry(shader, fragment);
    let inputs = Varyings::inputs(shader.module(), fragment);
    check_locations(&at, "reads", &inputs, most, scope)?;
    check_varyings(&at, "reads", &inputs, inputs.builtins, most, scope)?;
    let most = limits.max_color_attachments;
    // Too many targets were reported already.
    if draw.colors.len() <= most as usize {
        let outputs = Varyings::outputs(shader.module(), fragment);
        check_locations(&at, "writes", &outputs, most, scope)?;
    }
    let given = vertex.map_or_else(Varyings::default, |index| {
        Varyings::outputs(shader.module(), index)
    });
    let mut wrong = None;
    for taken in &inputs.locations {
        if let Some(why) = misfit(taken, &given.locations) {
            wrong = Some(scope.report(LimitError::NoVarying {
                entry: at.clone(),
                location: taken.location,
                why,
                vertex: vertex.map(|index| shader.entry_span(index)),
            }));
        }
    }
    wrong.map_or(Ok(()), Err)
}

fn check_locations(
    at: &Entry,
    verb: &'static str,
    varyings: &Varyings,
    most: u32,
    scope: &mut PassScope<'_>,
) -> Reported<()> {
    let locations = varyings.locations.iter().map(|varying| varying.location);
    match locations.max() {
        Some(location) if location >= most => scope.unsupported(LimitError::Location {
            entry: at.clone(),
            verb,
            location,
            most,
        }),
        _ => Ok(()),
    }
}

fn check_varyings(
    at: &Entry,
    verb: &'static str,
    varyings: &Varyings,
    builtins: u32,
    most: u32,
    scope: &mut PassScope<'_>,
) -> Reported<()> {
    let number = varyings.locations.len() as u64 + u64::from(builtins);
    if number <= u64::from(most) {
        return Ok(());
    }
    scope.unsupported(LimitError::TooManyVaryings {
        entry: at.clone(),
        verb,
        number,
        builtins,
        most,
    })
}

fn entry(shader: &Shader, index: usize) -> Entry {
    Entry {
        file: shader.file().to_owned(),
        name: shader.entry_name(index).to_owned(),
        span: shader.entry_span(index),
    }
}

fn beyond(memory: &Memory, most: u64, entry: &Entry) -> Option<Excess> {
    let (of_largest, largest) = memory.largest(&entry.span);
    (memory.bytes > most).then_some(Excess {
        bytes: memory.bytes,
        most,
        of_largest,
        largest,
    })
}

/// Returns the reason for which a fragment shader cannot take an output of the vertex shader;
/// `None` if it can.
fn misfit(taken: &Varying, given: &[Varying]) -> Option<String> {
    let Some(given) = given.iter().find(|given| given.location == taken.location) else {
        return Some("no vertex shader writes".to_owned());
    };
    if given.scalar != taken.scalar || given.width < taken.width {
        return Some(format!(
            "holds {} × {}, not {} × {}",
            given.width,
            given.scalar.as_str(),
            taken.width,
            taken.scalar.as_str()
        ));
    }
    let same = given.interpolation == taken.interpolation && given.sampling == taken.sampling;
    (!same).then(|| "is interpolated differently in the vertex shader".to_owned())
}
