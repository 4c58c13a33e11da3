//! Finds the outputs and captures that can be read back, and reports the others with a reason.

use crate::compose::Loaded;
use crate::diagnostics::Reports;
use crate::errors::plan::OutputError;
use crate::expressions::Environment;
use crate::instantiate::{At, LoweredPass, PlanInputs, SymbolTable};
use crate::request::{Capture, PlanRequest};
use crate::resource::{Origin, ResourceKind, Target};

/// Returns names and targets of all outputs and captures that the request wants. `written` tells if
/// a pass writes a target. Notes in `plan_inputs` the params and features in conditions of outputs.
pub(super) fn readable(
    graph: &Loaded,
    request: &PlanRequest<'_>,
    at: &mut At<'_, '_>,
    written: impl Fn(&Target) -> bool,
    plan_inputs: &mut PlanInputs,
) -> Vec<(String, Target)> {
    let mut readable = Vec::new();
    let outputs = graph.document.material_outputs();
    let declared: Vec<&str> = outputs.map(|output| output.name.as_str()).collect();
    for wanted in request.outputs.iter().flatten() {
        if !declared.contains(&wanted.as_str()) {
            at.report(OutputError::NoOutput {
                graph: graph.path().to_owned(),
                name: wanted.clone(),
                outputs: declared.iter().map(|&name| name.to_owned()).collect(),
            });
        }
    }
    let is_wanted = |name: &String, on_request: bool| {
        let is_captured = || request.captures.iter().any(|it| it.name() == *name);
        match &request.outputs {
            Some(wanted) => wanted.contains(name),
            None => !on_request || is_captured(),
        }
    };
    for output in graph.document.material_outputs() {
        if plan_inputs.is_there(output.condition.as_ref(), at) != Ok(true) {
            continue;
        }
        let name = output.name.text();
        let material = &output.material;
        let Ok(target) = at.resolve(material) else {
            continue;
        };
        if !written(&target) {
            let material = material.located();
            at.report(OutputError::UnwrittenOutput { name, material });
        } else if !is_wanted(&name.value, output.on_request) && is_import(at.symbols, &target) {
            // A pass may write an import only where it is listed as an output.
            continue;
        } else if let Some((what, way_out)) = unreadable(at.symbols, &target) {
            at.report(OutputError::UnreadableOutput {
                name,
                material: material.span.clone(),
                what,
                way_out,
            });
        } else if is_wanted(&name.value, output.on_request) {
            readable.push((name.value, target));
        }
    }
    for capture in &request.captures {
        let name = capture.name();
        if readable.iter().any(|(other, _)| *other == name) {
            continue;
        }
        let Some(target) = captured(graph, capture, &declared, at) else {
            continue;
        };
        if at.symbols.get(target.id).kind.is_given() {
            at.report(OutputError::Provided(name));
        } else if !written(&target) {
            at.report(OutputError::Unwritten(name));
        } else if let Some((what, _)) = unreadable(at.symbols, &target) {
            at.report(OutputError::Unreadable { name, what });
        } else {
            readable.push((name, target));
        }
    }
    readable
}

/// Returns the material that is captured, and reports a name that none has.
fn captured(
    graph: &Loaded,
    capture: &Capture,
    declared: &[&str],
    at: &mut At<'_, '_>,
) -> Option<Target> {
    let name = capture.name();
    // Those after a pass were entered as resources of their own.
    if let Some(target) = at.symbols.find_full(&name) {
        return target.ok();
    }
    if capture.after.is_none() {
        let outputs = declared.iter().map(|&name| name.to_owned());
        let materials = at.symbols.full_names().into_iter().chain(outputs);
        let materials = at.reports().known(materials);
        at.report(OutputError::NoMaterial {
            graph: graph.path().to_owned(),
            name,
            materials,
        });
    }
    None
}

/// Reports captures after passes that do not exist.
pub(super) fn check_captures(
    request: &PlanRequest<'_>,
    lowered: &[LoweredPass<'_>],
    reports: &mut Reports,
) {
    let captures = request.captures.iter();
    let after = captures.filter_map(|capture| capture.after.as_deref());
    for name in after {
        if !lowered.iter().any(|pass| pass.flat.name.value == name) {
            let passes = lowered.iter().map(|pass| pass.flat.name.value.clone());
            reports.report(OutputError::NoPass(name.to_owned(), passes.collect()));
        }
    }
}

fn is_import(symbols: &SymbolTable<'_>, target: &Target) -> bool {
    symbols.get(target.id).origin == Origin::Host
}

/// Describes a resource that cannot be read back, with a way out; `None` for any other.
fn unreadable(symbols: &SymbolTable<'_>, target: &Target) -> Option<(String, &'static str)> {
    let texture = match &symbols.get(target.id).kind {
        ResourceKind::Texture(texture) => texture,
        ResourceKind::Sampler(_) => {
            let what = "a sampler, which has no content";
            return Some((what.to_owned(), "name a texture or buffer"));
        }
        _ => return None,
    };
    let (samples, format) = (texture.samples, texture.format);
    if samples > 1 {
        let way_out = "name a texture of one sample that a `resolve` is written to";
        return Some((format!("a texture of {samples} samples"), way_out));
    }
    if format.is_compressed() {
        let what = format!("a texture of the compressed format {format:?}");
        return Some((
            what,
            "draw it to a texture of another format, and name that",
        ));
    }
    if format.block_copy_size(None).is_none() {
        let what = format!("a texture of format {format:?}, whose layout is the driver's own");
        return Some((what, "use Depth32Float or Depth16Unorm"));
    }
    None
}
