//! Finds all mistakes of a graph, for all values that decide which entries exist.

use super::make::{Outcome, Planned, plan_all};
use super::plan::Plan;
use crate::compose::{Loaded, Used};
use crate::diagnostics::{Code, Diagnostic, Diagnostics, Reports, Severity};
use crate::document::{Document, Entry, InputKind, Invalid, What};
use crate::errors::flow::OrderError;
use crate::instantiate::PlanInputs;
use crate::instantiate::params::claims;
use crate::param::{Param, ParamType, ParamValue};
use crate::provider::Import;
use crate::request::PlanRequest;
use crate::source::{Located, Span};
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

/// Formats that are tried for an input that takes any format; the shader's declaration decides
/// which fits.
const TRIED: [wgt::TextureFormat; 5] = [
    wgt::TextureFormat::Rgba16Float,
    wgt::TextureFormat::Rgba32Uint,
    wgt::TextureFormat::Rgba32Sint,
    wgt::TextureFormat::Depth32Float,
    wgt::TextureFormat::R32Float,
];

/// Plans a document that was read with the mistakes in `errors`. Returns the plan, or these
/// mistakes and all others. Plans again for each other value of each param and feature in an `if`,
/// changed one at a time.
pub(crate) fn check(
    graph: &Arc<Loaded>,
    mut errors: Vec<Diagnostic>,
    request: &PlanRequest<'_>,
) -> Result<Plan, Diagnostics> {
    let mut request = request.clone();
    if request.any_adapter {
        // It says itself that not every adapter will do.
        request.features |= graph.required;
    }
    let request = &request;
    // Without its params nothing of the document has a size.
    let outcome = match graph.document.invalid_params {
        None => plan_for_any(graph, request),
        Some(_) => Outcome::default(),
    };
    if outcome.plan.is_some() && errors.is_empty() {
        errors.extend(sweep(graph, request, &outcome.plan_inputs));
        let mut reports = Reports::default();
        let context = request.surroundings();
        claims(&graph.document, &request.params, context, &mut reports);
        if reports.errors() > 0 {
            errors.extend(reports.into_list());
        }
    }
    errors.retain(|error| !follows(error, &outcome.found));
    errors.extend(outcome.found);
    match outcome.plan {
        Some(mut plan) if errors.is_empty() => {
            let idle = unneeded(graph, &plan);
            plan.warnings.extend(idle);
            Ok(Plan(plan))
        }
        // A misspelt name leaves the item that it meant unused: warnings wait until the errors are
        // gone.
        _ => Err(graph.diagnostics(errors)),
    }
}

/// True if a shader is not valid since a global in the same file has a type that does not fit what
/// is bound to it: a fault of types in a function, which mostly tells nothing of the cause.
fn follows(error: &Diagnostic, diagnostics: &[Diagnostic]) -> bool {
    let is_of_types = error.code == Code::Shader
        && !["expected ", "no definition", "invalid field"]
            .iter()
            .any(|begin| {
                let begins = format!("does not compile: {begin}");
                error.message.contains(&begins)
            });
    let file = |it: &Diagnostic| it.labels.first().map(|label| label.span.file.name.clone());
    let is_cause = |other: &Diagnostic| {
        let codes = [
            Code::FormatMismatch,
            Code::ResourceKind,
            Code::LayoutMismatch,
        ];
        codes.contains(&other.code) && file(other) == file(error)
    };
    is_of_types && diagnostics.iter().any(is_cause)
}

/// Plans with stand-ins for the imports that the request lacks: resources as the document asks for
/// them.
fn plan_for_any(graph: &Arc<Loaded>, request: &PlanRequest<'_>) -> Outcome {
    let takes_any = graph.document.inputs.iter().any(|input| {
        matches!(input.kind, InputKind::Texture(None))
            && !request.imports.contains_key(input.name.as_str())
    });
    let tried = if takes_any { &TRIED[..] } else { &TRIED[..1] };
    let mut first = None;
    for format in tried {
        let request = PlanRequest {
            imports: stand_ins(&graph.document, request, *format),
            ..request.clone()
        };
        let outcome = plan_all(graph, &request);
        if outcome.plan.is_some() {
            return outcome;
        }
        first.get_or_insert(outcome);
    }
    first.unwrap_or_else(|| plan_all(graph, request))
}

/// Returns the request's imports, and stand-ins for the inputs of the document without one.
fn stand_ins(
    document: &Document,
    request: &PlanRequest<'_>,
    any: wgt::TextureFormat,
) -> BTreeMap<String, Import> {
    let mut imports = request.imports.clone();
    for input in &document.inputs {
        let import = match input.kind {
            InputKind::Texture(format) => {
                let usages = wgt::TextureUsages::all();
                Import::plain_texture(format.unwrap_or(any), request.viewport, usages)
            }
            InputKind::Buffer => Import::buffer(u32::MAX.into(), Some(1), wgt::BufferUsages::all()),
            InputKind::Sampler { compare } => Import::sampler(Default::default(), compare),
        };
        let name = input.name.value.to_string();
        imports.entry(name).or_insert(import);
    }
    imports
}

/// Returns the mistakes for other values of the params and features that decide which entries
/// exist, changed one at a time.
fn sweep(
    graph: &Arc<Loaded>,
    request: &PlanRequest<'_>,
    plan_inputs: &PlanInputs,
) -> Vec<Diagnostic> {
    let mut diagnostics = Vec::new();
    for name in &plan_inputs.params {
        let Ok(param) = graph.param(name) else {
            continue;
        };
        for value in ends(param) {
            let mut changed = request.clone();
            changed.params.insert(name.clone(), value.clone());
            let condition = format!("with `{name}` = {value}");
            diagnostics.extend(wrong_with(graph, &changed, &condition));
        }
    }
    for feature in plan_inputs.features.iter() {
        let mut changed = request.clone();
        changed.features.toggle(feature);
        let has = if changed.features.contains(feature) {
            "with"
        } else {
            "without"
        };
        let names: Vec<&str> = feature.iter_names().map(|(name, _)| name).collect();
        let condition = format!("{has} the feature {}", names.join(", "));
        diagnostics.extend(wrong_with(graph, &changed, &condition));
    }
    diagnostics
}

/// Returns warnings about passes of the document itself that write nothing that another entry or an
/// output of it names. Passes of included documents may well make more than is used here.
fn unneeded(graph: &Loaded, plan: &Planned) -> Vec<Diagnostic> {
    let document = &graph.document;
    let live: BTreeSet<usize> = plan.schedule.passes.iter().map(|id| id.index()).collect();
    let mut reports = Reports::default();
    let mut warned: Vec<&Span> = Vec::new();
    for (index, pass) in plan.passes.iter().enumerate() {
        let place = &pass.name.span;
        if live.contains(&index) || place.file != document.file || warned.contains(&place) {
            continue;
        }
        let mut reduced = Document::clone(document);
        remove(&mut reduced.entries, place);
        let used = Used::new(&reduced, &graph.shaders).materials;
        let written = pass.accesses.iter().filter(|access| access.writes);
        let written = written.map(|access| &*plan.resources[access.resource.index()].name);
        let written: BTreeSet<&str> = written.collect();
        let is_used = |name: &&str| {
            let name = name.split(['.', '[']).next().unwrap_or_default();
            used.contains(name) || used.contains(&format!("{name}_previous"))
        };
        if !written.iter().any(is_used) {
            warned.push(place);
            let name = pass.name.split('[').next().unwrap_or_default();
            reports.warn(OrderError::Unneeded {
                pass: Located::new(name.to_owned(), place.clone()),
                written: written.into_iter().map(str::to_owned).collect(),
            });
        }
    }
    reports.into_list()
}

/// Removes the entry whose name stands at `place`.
fn remove(entries: &mut Vec<Result<Entry, Invalid>>, place: &Span) {
    entries.retain(|entry| !matches!(entry, Ok(entry) if entry.name.span == *place));
    for entry in entries.iter_mut().flatten() {
        if let What::Group(inner) = &mut entry.what {
            remove(inner, place);
        }
    }
}

/// Returns the mistakes that a changed request causes; `condition` describes the change. Mistakes
/// of limits, memory, features and lights are left out.
fn wrong_with(graph: &Arc<Loaded>, request: &PlanRequest<'_>, condition: &str) -> Vec<Diagnostic> {
    let outcome = plan_for_any(graph, request);
    let errors = outcome.found.into_iter();
    let errors = errors.filter(|diagnostic| diagnostic.severity == Severity::Error);
    // A value at the end of a range may well be too large for a device, or for memory; a word
    // may be for other lights.
    let errors = errors.filter(|diagnostic| {
        !matches!(
            diagnostic.code,
            Code::Limit | Code::Size | Code::Memory | Code::Feature | Code::Light | Code::Need
        )
    });
    errors
        .map(|diagnostic| Diagnostic {
            code: Code::Condition,
            message: format!("{condition}: {}", diagnostic.message),
            ..diagnostic
        })
        .collect()
}

/// Returns the values of a param that `check` tries: every word, true and false, or the ends of its
/// range.
fn ends(param: &Param) -> Vec<ParamValue> {
    match &param.ty {
        ParamType::Bool => [true, false].map(ParamValue::Bool).to_vec(),
        ParamType::Choice(_) => param
            .words()
            .map(|word| ParamValue::Choice(word.to_string()))
            .collect(),
        ParamType::Vec2 | ParamType::Vec3 | ParamType::Vec4 => Vec::new(),
        ty => {
            let numbers = [param.min, param.max].into_iter().flatten();
            let numbers = numbers.filter_map(|number| ty.with_number(number));
            numbers.collect()
        }
    }
}
