//! naga's errors in our words, at the author's places.

use super::Expanded;
use crate::{
    diagnostics::{Code, Diagnostic},
    source::Span,
};
use naga::{
    Handle,
    valid::{EntryPointError, ValidationError},
};

/// The place of the name of a function.
pub(super) fn function_span(source: &Expanded, name: &str) -> Span {
    let text = &source.text;
    let at = words(text, name)
        .find(|&at| text[..at].trim_end().ends_with("fn"))
        .unwrap_or(0);
    source.locate(at..at + name.len())
}

/// Where `word` stands in `text` as a whole word.
pub(super) fn words<'a>(text: &'a str, word: &'a str) -> impl Iterator<Item = usize> + 'a {
    let is_part = |c: char| c.is_alphanumeric() || c == '_';
    text.match_indices(word)
        .map(|(at, _)| at)
        .filter(move |&at| {
            !text[..at].ends_with(is_part) && !text[at + word.len()..].starts_with(is_part)
        })
}

/// Two globals that one entry point uses under one number.
fn collision(
    handle: Handle<naga::GlobalVariable>,
    module: &naga::Module,
    source: &Expanded,
) -> Diagnostic {
    let binding = module.global_variables[handle].binding;
    let place = |handle| {
        module
            .global_variables
            .get_span(handle)
            .to_range()
            .unwrap_or(0..0)
    };
    let name = |handle: Handle<naga::GlobalVariable>| {
        module.global_variables[handle]
            .name
            .clone()
            .unwrap_or_default()
    };
    let number = binding.map_or(String::new(), |binding| {
        format!("@group({}) @binding({})", binding.group, binding.binding)
    });
    let message = format!(
        "`{}` of `{}` has a binding number that is taken: {number}",
        name(handle),
        source.file.name
    );
    let others = module
        .global_variables
        .iter()
        .filter(|(other, variable)| *other != handle && variable.binding == binding);
    others
        .fold(
            Diagnostic::error(Code::Binding, message).at(source.locate(place(handle)), "this one"),
            |diagnostic, (other, _)| {
                diagnostic.at(
                    source.locate(place(other)),
                    format!("`{}` has it too", name(other)),
                )
            },
        )
        .help("leave the numbers out: the graph gives them")
}

pub(super) fn parse_error(error: &naga::front::wgsl::ParseError, source: &Expanded) -> Diagnostic {
    let mut diagnostic = Diagnostic::error(
        Code::Shader,
        format!(
            "`{}` does not compile: {}",
            source.file.name,
            error.message()
        ),
    );
    for (span, text) in error.labels() {
        if let Some(range) = span.to_range() {
            diagnostic = diagnostic.at(source.locate(range), text);
        }
    }
    if diagnostic.labels.is_empty() {
        // naga gives no place where a type is too large.
        diagnostic = diagnostic.at(source.file.span(0..0), "");
    }
    let notes: Vec<&str> = error.notes().collect();
    if notes.is_empty() {
        diagnostic
    } else {
        diagnostic.help(notes.join("\n"))
    }
}

pub(super) fn validation_error(
    error: &naga::WithSpan<ValidationError>,
    module: &naga::Module,
    source: &Expanded,
) -> Diagnostic {
    if let ValidationError::EntryPoint {
        source: EntryPointError::BindingCollision(handle),
        ..
    } = error.as_inner()
    {
        return collision(*handle, module, source);
    }
    // The causes say what is wrong; the outermost one only which function.
    let mut message = format!("`{}` is not valid: {}", source.file.name, error.as_inner());
    let mut cause = std::error::Error::source(error.as_inner());
    while let Some(inner) = cause {
        message.push_str(&format!(": {inner}"));
        cause = inner.source();
    }
    let mut diagnostic = Diagnostic::error(Code::Shader, message);
    for (span, text) in error.spans() {
        if let Some(range) = span.to_range() {
            // Some spans are labelled with a handle of naga's, which tells an author nothing.
            let text = if text.starts_with("naga::") { "" } else { text };
            diagnostic = diagnostic.at(source.locate(range), text);
        }
    }
    if diagnostic.labels.is_empty() {
        let place = match error.as_inner() {
            ValidationError::EntryPoint { name, .. } => function_span(source, name),
            _ => source.file.span(0..0),
        };
        diagnostic = diagnostic.at(place, "");
    }
    diagnostic
}
