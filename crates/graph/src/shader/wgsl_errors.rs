//! Turns naga's errors into the crate's, at their places in the author's files.

use super::expand::Expanded;
use super::text::{Declared, words};
use crate::diagnostics::suggest::{likeness, suggestion};
use crate::errors::shader::ShaderError;
use crate::source::Span;
use naga::Handle;
use naga::back::pipeline_constants::PipelineConstantError;
use naga::common::wgsl::TypeContext;
use naga::valid::{
    EntryPointError, FunctionError, GlobalVariableError, TypeFlags, ValidationError,
};
use std::ops::Range;

/// Returns the byte range of a function's name in the expanded text.
pub(super) fn function_range(source: &Expanded, name: &str) -> Range<usize> {
    let text = &source.text;
    let is_function = |at: &usize| text[..*at].trim_end().ends_with("fn");
    let at = words(text, name).find(is_function).unwrap_or(0);
    at..at + name.len()
}

/// Returns the place of a function's name in the author's file.
pub(super) fn function_span(source: &Expanded, name: &str) -> Span {
    source.locate(function_range(source, name))
}

/// Two globals that one entry point uses under one number.
fn collision(
    handle: Handle<naga::GlobalVariable>,
    module: &naga::Module,
    source: &Expanded,
) -> ShaderError {
    let globals = &module.global_variables;
    let binding = globals[handle].binding;
    let place = |handle| source.place(globals.get_span(handle));
    let name = |handle: Handle<naga::GlobalVariable>| globals[handle].name.clone();
    let clashing = globals
        .iter()
        .filter(|(other, variable)| *other != handle && variable.binding == binding)
        .map(|(other, _)| (place(other), name(other).unwrap_or_default()));
    ShaderError::Collision {
        file: source.file.name.to_string(),
        global: name(handle).unwrap_or_default(),
        number: binding.map_or(String::new(), |binding| {
            format!("@group({}) @binding({})", binding.group, binding.binding)
        }),
        at: place(handle),
        clashing: clashing.collect(),
    }
}

/// The file that the first of the places lies in, and which shader imports it.
fn blamed(places: &[(Span, String)], source: &Expanded) -> String {
    let shader = &source.file.name;
    match places.first().map(|(span, _)| &span.file.name) {
        Some(file) if file != shader => format!("`{file}`, imported by `{shader}`,"),
        _ => format!("`{shader}`"),
    }
}

pub(super) fn parse_error(error: &naga::front::wgsl::ParseError, source: &Expanded) -> ShaderError {
    let labels = error.labels();
    let place =
        |(span, text): (naga::Span, &str)| Some((source.locate(span.to_range()?), text.to_owned()));
    let mut places: Vec<(Span, String)> = labels.filter_map(place).collect();
    if places.is_empty() {
        // naga gives no place where a type is too large.
        places.push((source.file.span(0..0), String::new()));
    }
    let notes = error.notes().map(str::to_owned);
    let notes = notes.chain(meant(error.message(), source)).collect();
    let what = format!("does not compile: {}", error.message());
    ShaderError::Naga(blamed(&places, source), what, places, notes)
}

/// Suggests a field or name in place of an unknown one.
fn meant(message: &str, source: &Expanded) -> Option<String> {
    let declared = Declared::new(&source.text);
    if let Some(word) = unknown_name(message) {
        let constants = source.constants.iter().map(String::as_str);
        return likeness(word, declared.names.into_iter().chain(constants));
    }
    match message.split('`').collect::<Vec<_>>()[..] {
        ["invalid field accessor ", word, ..] => suggestion(word, declared.fields),
        _ => None,
    }
}

/// Returns the name that a message of naga's calls unknown.
pub(super) fn unknown_name(message: &str) -> Option<&str> {
    let (_, rest) = [
        "no definition in scope for identifier: `",
        "unknown type: `",
    ]
    .iter()
    .find_map(|begin| message.split_once(begin))?;
    rest.split('`').next()
}

/// naga's words without its numbers of types and expressions: `type [2]` becomes the type's name,
/// and of an expression the place tells which one it is.
fn without_handles(what: &str, module: &naga::Module) -> String {
    let mut message = String::new();
    let mut rest = what;
    while let Some(at) = rest.find(" [") {
        let (before, after) = (&rest[..at], &rest[at + 2..]);
        let number = after.split_once(']').and_then(|(number, after)| {
            let number: usize = number.parse().ok()?;
            Some((number, after))
        });
        message.push_str(before);
        rest = match number {
            Some((number, after)) => {
                let ty = module.types.iter().nth(number);
                let is_type = before.ends_with("type") || before.ends_with("types like");
                if let Some((ty, _)) = ty.filter(|_| is_type) {
                    message.push_str(&format!(" `{}`", module.to_ctx().type_to_string(ty)));
                }
                after
            }
            None => {
                message.push_str(" [");
                after
            }
        };
    }
    message + rest
}

/// An error of naga's with its causes: they say what is wrong; the outermost one only which
/// function.
fn in_full(error: &dyn std::error::Error, module: &naga::Module) -> String {
    let mut what = error.to_string();
    let mut cause = error.source();
    while let Some(inner) = cause {
        what.push_str(&format!(": {inner}"));
        cause = inner.source();
    }
    // Only structs have names.
    plain_types(without_handles(&what, module)).replace("Type '' is", "a type is")
}

/// Writes types as WGSL does that naga prints as its own structs.
fn plain_types(mut what: String) -> String {
    const SIZES: [(&str, u32); 3] = [("Bi", 2), ("Tri", 3), ("Quad", 4)];
    let kinds = [("Float", "f"), ("Sint", "i"), ("Uint", "u")];
    let of_size = |bits: u32| kinds.map(|(kind, sign)| (kind, bits, format!("{sign}{bits}")));
    let sized = [16, 32, 64].map(of_size);
    let unsized_scalars = [
        ("Bool", 8, "bool".to_owned()),
        ("AbstractInt", 64, "a whole number".to_owned()),
        ("AbstractFloat", 64, "a number".to_owned()),
    ];
    for (kind, bits, name) in sized.into_iter().flatten().chain(unsized_scalars) {
        let scalar = format!("Scalar {{ kind: {kind}, width: {} }}", bits / 8);
        for (size, rows) in SIZES {
            let vector = format!("Vector {{ size: {size}, scalar: {scalar} }}");
            what = what.replace(&vector, &format!("vec{rows}<{name}>"));
            for (columns, count) in SIZES {
                let matrix =
                    format!("Matrix {{ columns: {columns}, rows: {size}, scalar: {scalar} }}");
                what = what.replace(&matrix, &format!("mat{count}x{rows}<{name}>"));
            }
        }
        what = what.replace(&format!("Scalar({scalar})"), &name);
        what = what.replace(&scalar, &name);
    }
    // naga tells numbers of expressions, which are left out, and their types.
    while let Some((before, rest)) = what.split_once("(of type ") {
        let (ty, after) = rest.split_once(')').unwrap_or((rest, ""));
        what = format!("{before}`{ty}`{after}");
    }
    what
}

/// Rewords an error that naga tells by its own numbers and flags.
fn plainly(error: &ValidationError, module: &naga::Module) -> Option<String> {
    let of_function = |name: &str, fault: &FunctionError| match fault {
        FunctionError::InvalidReturnType {
            expression,
            expected_ty,
        } => {
            let ty = expected_ty.map(|ty| module.to_ctx().type_to_string(ty));
            Some(match (ty, expression) {
                (Some(ty), Some(_)) => format!("`{name}` returns something else than its `{ty}`"),
                (Some(ty), None) => format!("`{name}` can end without returning its `{ty}`"),
                (None, _) => format!("`{name}` returns a value, but declares none"),
            })
        }
        _ => None,
    };
    match error {
        ValidationError::Function { name, source, .. } => of_function(name, source),
        ValidationError::EntryPoint {
            name,
            source: EntryPointError::Function(fault),
            ..
        } => of_function(name, fault),
        ValidationError::GlobalVariable {
            name,
            source: GlobalVariableError::MissingTypeFlags { required, seen },
            ..
        } => {
            let wanted = [
                (TypeFlags::SIZED, "a size that is known when it is compiled"),
                (
                    TypeFlags::HOST_SHAREABLE,
                    "a layout that the host can share: no `bool`",
                ),
                (TypeFlags::COPY, "values that can be copied"),
                (TypeFlags::CREATION_RESOLVED, "a size without overrides"),
                (TypeFlags::DATA, "plain data"),
            ];
            let missing = *required - *seen;
            let lacks = wanted.iter().filter(|(flag, _)| missing.contains(*flag));
            let lacks: Vec<&str> = lacks.map(|(_, words)| *words).collect();
            let lacks = lacks.join(", ");
            (!lacks.is_empty()).then(|| format!("the type of `{name}` needs {lacks}"))
        }
        _ => None,
    }
}

/// Iterates over all functions of a module, including its entry points.
pub(super) fn functions(module: &naga::Module) -> impl Iterator<Item = &naga::Function> {
    let functions = module.functions.iter().map(|(_, function)| function);
    functions.chain(module.entry_points.iter().map(|entry| &entry.function))
}

/// The place of what has a type that is written where it is used.
fn user_of(ty: Handle<naga::Type>, module: &naga::Module, source: &Expanded) -> Option<Span> {
    let located = |span: naga::Span| Some(source.locate(span.to_range()?));
    let mut globals = module.global_variables.iter();
    if let Some((global, _)) = globals.find(|(_, global)| global.ty == ty) {
        return located(module.global_variables.get_span(global));
    }
    functions(module).find_map(|function| {
        let mut locals = function.local_variables.iter();
        if let Some((local, _)) = locals.find(|(_, local)| local.ty == ty) {
            return located(function.local_variables.get_span(local));
        }
        let arguments = function.arguments.iter().map(|argument| argument.ty);
        let mut types = arguments.chain(function.result.iter().map(|result| result.ty));
        let name = function.name.as_deref()?;
        let is_of_type = types.any(|it| it == ty);
        is_of_type.then(|| function_span(source, name))
    })
}

pub(super) fn validation_error(
    error: &naga::WithSpan<ValidationError>,
    module: &naga::Module,
    source: &Expanded,
) -> ShaderError {
    if let ValidationError::EntryPoint {
        source: EntryPointError::BindingCollision(handle),
        ..
    } = error.as_inner()
    {
        return collision(*handle, module, source);
    }
    let message = plainly(error.as_inner(), module);
    let message = message.unwrap_or_else(|| in_full(error.as_inner(), module));
    let place = |(span, text): &(naga::Span, String)| {
        // Some spans are labelled with a handle of naga's, which tells an author nothing.
        let text = if text.starts_with("naga::") { "" } else { text };
        Some((source.locate(span.to_range()?), text.to_owned()))
    };
    let mut places: Vec<(Span, String)> = error.spans().filter_map(place).collect();
    if places.is_empty() {
        use ValidationError as V;
        let span = match error.as_inner() {
            V::Type { handle, .. } => module.types.get_span(*handle),
            V::ConstExpression { handle, .. } => module.global_expressions.get_span(*handle),
            V::Constant { handle, .. } => module.constants.get_span(*handle),
            V::Override { handle, .. } => module.overrides.get_span(*handle),
            V::GlobalVariable { handle, .. } => module.global_variables.get_span(*handle),
            V::Function { handle, .. } => module.functions.get_span(*handle),
            _ => naga::Span::UNDEFINED,
        };
        let place = match (span.to_range(), error.as_inner()) {
            (Some(range), _) => source.locate(range),
            (None, V::EntryPoint { name, .. }) => function_span(source, name),
            (None, V::Type { handle, .. }) => {
                user_of(*handle, module, source).unwrap_or_else(|| source.file.span(0..0))
            }
            (None, _) => source.file.span(0..0),
        };
        places.push((place, String::new()));
    }
    let what = format!("is not valid: {message}");
    ShaderError::Naga(blamed(&places, source), what, places, Vec::new())
}

/// Returns the error for an entry point that is not valid with the values of its overrides.
pub(super) fn specialisation_error(
    error: &PipelineConstantError,
    entry: &str,
    source: &Expanded,
) -> ShaderError {
    // Its numbers are those of a module that is gone.
    let message = in_full(error, &naga::Module::default());
    let what = format!("is not valid with the values of its overrides: {message}");
    let places = vec![(function_span(source, entry), String::new())];
    let file = format!("`{}`", source.file.name);
    ShaderError::Naga(file, what, places, Vec::new())
}
