//! The border to naga: parses, validates and writes SPIR-V, each of which panics on some valid
//! texts. A panic becomes an error that names the declaration and, in a function, the statement
//! that brings it about.

use super::binding_numbers::assign_bindings;
use super::blame::blamed_range;
use super::expand::Expanded;
use super::wgsl_errors::{function_range, parse_error, specialisation_error, validation_error};
use crate::errors::shader::ShaderError;
use naga::back::pipeline_constants::process_overrides;
use naga::back::spv::{self, PipelineOptions};
use naga::proc::{BoundsCheckPolicies, BoundsCheckPolicy, GlobalCtx, Layouter};
use naga::valid::{Capabilities, ModuleInfo, ValidationFlags, Validator};
use naga::{Module, ShaderStage};
use skiagraph_located_ron::panics::{Panicked, caught};
use std::borrow::Cow;

/// A valid module, with the facts that validation found and the layout of its types.
pub(super) type Valid = (Module, ModuleInfo, Layouter);

/// Parses and validates a shader with its imports in place.
pub(super) fn compiled(source: &Expanded) -> Result<Valid, ShaderError> {
    let read = caught(|| parsed_and_valid(source));
    read.unwrap_or_else(|panicked| Err(fault(source, panicked, "is read", None)))
}

fn parsed_and_valid(source: &Expanded) -> Result<Valid, ShaderError> {
    let mut module =
        naga::front::wgsl::parse_str(&source.text).map_err(|error| parse_error(&error, source))?;
    if let Some(error) = immediate(&module, source) {
        return Err(error);
    }
    assign_bindings(&mut module, &|at| source.is_imported(at));
    let info = validator().validate(&module);
    let info = info.map_err(|error| validation_error(&error, &module, source))?;
    let mut layouter = Layouter::default();
    layouter
        .update(GlobalCtx {
            types: &module.types,
            constants: &module.constants,
            overrides: &module.overrides,
            global_expressions: &module.global_expressions,
        })
        .map_err(|error| ShaderError::NoLayout(error.to_string(), source.file.span(0..0)))?;
    Ok((module, info, layouter))
}

/// The first global that the host would set with the commands, which a graph never does. naga's
/// validation counts their bytes in 64 bits, and panics where they are more than 256.
fn immediate(module: &Module, source: &Expanded) -> Option<ShaderError> {
    let mut globals = module.global_variables.iter();
    let (handle, global) =
        globals.find(|(_, global)| global.space == naga::AddressSpace::Immediate)?;
    let name = global.name.clone().unwrap_or_default();
    let at = source.place(module.global_variables.get_span(handle));
    let file = source.file.name.to_string();
    Some(ShaderError::Immediate(file, name, at))
}

/// A document is checked against the language. Features that a device lacks are reported when a
/// pipeline is made for it.
fn validator() -> Validator {
    Validator::new(ValidationFlags::all(), Capabilities::all())
}

/// A module with the values of an entry point's overrides put in, as a device compiles it.
pub(super) struct Specialised<'a> {
    pub module: Cow<'a, Module>,
    pub info: Cow<'a, ModuleInfo>,
}

/// Puts the values of the overrides in, and writes the entry point as SPIR-V, as wgpu does for
/// Vulkan devices. Errors and panics of naga are so found before there is a device; the SPIR-V is
/// thrown away.
pub(super) fn specialised<'a>(
    (module, info): (&'a Module, &'a ModuleInfo),
    (stage, name): (ShaderStage, &str),
    constants: &[(String, f64)],
    source: &Expanded,
) -> Result<Specialised<'a>, ShaderError> {
    let constants = constants.iter().cloned().collect();
    let entry = Some((stage, name));
    let put_in = caught(|| {
        let (module, info) = process_overrides(module, info, entry, &constants)
            .map_err(|error| specialisation_error(&error, name, source))?;
        Ok(Specialised { module, info })
    });
    let panicked = |panicked, while_it| fault(source, panicked, while_it, Some(name));
    let specialised = put_in.map_err(|it| panicked(it, "gets its overrides"))??;
    let pipeline = PipelineOptions {
        shader_stage: stage,
        entry_point: name.to_owned(),
    };
    let written = caught(|| write(&specialised.module, &specialised.info, Some(&pipeline)));
    written.map_err(|it| panicked(it, "is written as SPIR-V"))?;
    Ok(specialised)
}

/// Writes as wgpu does for Vulkan. The writer's errors about features are left to the device.
fn write(module: &Module, info: &ModuleInfo, pipeline: Option<&PipelineOptions>) {
    let options = spv::Options {
        lang_version: (1, 6),
        flags: spv::WriterFlags::ADJUST_COORDINATE_SPACE | spv::WriterFlags::FORCE_POINT_SIZE,
        bounds_check_policies: BoundsCheckPolicies {
            index: BoundsCheckPolicy::Restrict,
            buffer: BoundsCheckPolicy::Restrict,
            image_load: BoundsCheckPolicy::Restrict,
            binding_array: BoundsCheckPolicy::Unchecked,
        },
        ..spv::Options::default()
    };
    drop(spv::write_vec(module, info, &options, pipeline));
}

/// True if naga panics on a text, whatever it does with it.
fn panics(text: &str) -> bool {
    let run = || {
        let Ok(mut module) = naga::front::wgsl::parse_str(text) else {
            return;
        };
        assign_bindings(&mut module, &|_| false);
        let Ok(info) = validator().validate(&module) else {
            return;
        };
        if module.overrides.is_empty() {
            return write(&module, &info, None);
        }
        for entry in &module.entry_points {
            let entry = Some((entry.stage, entry.name.as_str()));
            if let Ok((module, info)) =
                process_overrides(&module, &info, entry, &Default::default())
            {
                write(&module, &info, None);
            }
        }
    };
    caught(run).is_err()
}

/// A panic as an error, at what brings it about; where that is not found, at the entry point.
fn fault(
    source: &Expanded,
    panicked: Panicked,
    while_it: &'static str,
    entry: Option<&str>,
) -> ShaderError {
    let range = blamed_range(&source.text, &panics);
    let at = range.or_else(|| entry.map(|name| function_range(source, name)));
    ShaderError::Panicked {
        file: source.file.name.to_string(),
        while_it,
        panicked,
        at: source.locate(at.unwrap_or(0..0)),
    }
}
