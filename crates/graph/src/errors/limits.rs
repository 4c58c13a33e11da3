//! Shaders that ask more of a device than it has, or than WGSL promises of any.

use crate::{
    diagnostics::{code::Code, diagnostic::Diagnostic},
    source::span::{Located, Span},
};

/// An entry point of a shader.
#[derive(Clone, Debug)]
pub(crate) struct Entry {
    pub file: String,
    pub name: String,
    pub span: Span,
}

/// Bytes that are too many, and the variable that takes the most of them.
#[derive(Clone, Debug)]
pub(crate) struct Excess {
    pub bytes: u64,
    pub most: u64,
    /// Bytes of the largest variable.
    pub of_largest: u64,
    pub largest: Located<String>,
}

#[derive(Clone, Debug, thiserror::Error)]
pub(crate) enum LimitError {
    #[error(
        "workgroups of `{}` of `{}` share {} bytes, more than the adapter has",
        entry.name, entry.file, excess.bytes
    )]
    Workgroup { entry: Entry, excess: Excess },
    #[error(
        "the private variables of `{}` of `{}` take {} bytes of each thread",
        entry.name, entry.file, excess.bytes
    )]
    Private { entry: Entry, excess: Excess },
    #[error("the variables of `{function}` of `{file}` take {} bytes of each thread", excess.bytes)]
    Function {
        file: String,
        function: String,
        excess: Excess,
    },
    #[error(
        "the functions that `{}` of `{}` runs take {} bytes of each thread together",
        entry.name, entry.file, excess.bytes
    )]
    Functions { entry: Entry, excess: Excess },
    #[error("a value in `{}` of `{file}` has {bytes} bytes", **function)]
    Value {
        file: String,
        function: Located<String>,
        bytes: u64,
        most: u64,
    },
    #[error(
        "`{}` of `{}` {} {number} values between the stages, more than the adapter hands on",
        entry.name, entry.file, verb
    )]
    TooManyVaryings {
        entry: Entry,
        verb: &'static str,
        number: u64,
        builtins: u32,
        most: u32,
    },
    #[error(
        "`{}` of `{}` {verb} @location({location}), which the adapter does not have",
        entry.name, entry.file
    )]
    Location {
        entry: Entry,
        verb: &'static str,
        location: u32,
        most: u32,
    },
    #[error("`{}` of `{}` reads @location({location}), which {why}", entry.name, entry.file)]
    NoVarying {
        entry: Entry,
        location: u32,
        why: String,
        /// The vertex shader's, if it is not the graph's own.
        vertex: Option<Span>,
    },
    #[error(
        "`{}` of `{}` reads the vertex attribute @location({location})",
        entry.name, entry.file
    )]
    Attribute { entry: Entry, location: u32 },
    #[error("`{global}` of `{file}` has @binding({binding}), which the adapter does not have")]
    BindingNumber {
        file: String,
        global: String,
        binding: u32,
        most: u32,
        span: Span,
    },
}

impl From<LimitError> for Diagnostic {
    fn from(mistake: LimitError) -> Self {
        let diagnostic = Self::error(mistake.code(), mistake.to_string());
        mistake.explain(diagnostic)
    }
}

impl LimitError {
    fn code(&self) -> Code {
        match self {
            Self::NoVarying { .. } | Self::Attribute { .. } => Code::StageInterface,
            _ => Code::Limit,
        }
    }

    fn explain(self, diagnostic: Diagnostic) -> Diagnostic {
        match self {
            Self::Workgroup { excess, .. } => {
                let most = excess.most;
                largest(diagnostic, excess).help(format!(
                    "its limit is {most} bytes (max_compute_workgroup_storage_size); a buffer \
                     holds more"
                ))
            }
            Self::Private { excess, .. } | Self::Function { excess, .. } => {
                let most = excess.most;
                largest(diagnostic, excess).help(format!(
                    "no adapter tells a limit; WGSL promises {most} bytes, and drivers put them on \
                     the stack of each thread: a storage buffer holds more"
                ))
            }
            Self::Functions { excess, .. } => {
                let most = excess.most;
                largest(diagnostic, excess).help(format!(
                    "no adapter tells a limit; a graph takes {most} bytes, since drivers put all \
                     of them on the stack of each thread: a storage buffer holds more"
                ))
            }
            Self::Value { function, most, .. } => diagnostic.at(function.span, "").help(format!(
                "no adapter tells a limit; a graph takes {most} bytes, since drivers put a value \
                 on the stack of each thread: index the variable or buffer itself"
            )),
            Self::TooManyVaryings {
                entry,
                builtins,
                most,
                ..
            } => diagnostic.at(entry.span, counted(builtins)).help(format!(
                "its limit is {most} (max_inter_stage_shader_variables); put several into one vec4"
            )),
            Self::Location { entry, most, .. } => diagnostic
                .at(entry.span, "")
                .help(format!("locations count from 0, and it has {most} of them")),
            Self::NoVarying { entry, vertex, .. } => {
                let diagnostic = diagnostic.at(entry.span, "read here");
                match vertex {
                    Some(vertex) => diagnostic.at(vertex, "the vertex shader"),
                    None => diagnostic.help("the vertices of a Fullscreen pass hand nothing on"),
                }
            }
            Self::Attribute { entry, .. } => diagnostic.at(entry.span, "").help(
                "a graph has no vertex buffers: read a storage buffer at @builtin(vertex_index)",
            ),
            Self::BindingNumber { most, span, .. } => diagnostic.at(span, "").help(format!(
                "its numbers end below {most} (max_bindings_per_bind_group); leave them out: the \
                 graph gives them"
            )),
        }
    }
}

fn largest(diagnostic: Diagnostic, excess: Excess) -> Diagnostic {
    let text = format!("`{}` takes {} bytes", *excess.largest, excess.of_largest);
    diagnostic.at(excess.largest.span, text)
}

fn counted(builtins: u32) -> String {
    match builtins {
        0 => String::new(),
        _ => format!("{builtins} of them for its built-in values"),
    }
}
