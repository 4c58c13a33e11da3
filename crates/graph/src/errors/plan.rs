//! Requests that a plan cannot meet.

use crate::{
    diagnostics::{code::Code, diagnostic::Diagnostic},
    source::span::{Located, Span},
};

#[derive(Clone, Debug, thiserror::Error)]
pub(crate) enum OutputError {
    #[error("`{graph}` has no output `{name}`")]
    NoOutput {
        graph: String,
        name: String,
        known: Vec<String>,
    },
    #[error("`{graph}` has no material `{name}` to read back")]
    NoMaterial {
        graph: String,
        name: String,
        known: Vec<String>,
    },
    #[error("unknown pass `{name}` to read a material after")]
    NoPass { name: String, known: Vec<String> },
    #[error("`{0}` cannot be read back")]
    Unsized(String),
    #[error("`{0}` is a sampler and has no content")]
    Sampler(String),
    #[error("`{0}` is provided, not written by a pass")]
    Provided(String),
    #[error("`{0}` cannot be read back: no pass writes it")]
    Unwritten(String),
    #[error("`{name}` cannot be read back: it is {what}")]
    Unreadable { name: String, what: String },
    #[error("no pass writes the output `{}`", **name)]
    UnwrittenOutput {
        name: Located<String>,
        material: Located<String>,
    },
    #[error("the output `{}` cannot be read back", **name)]
    UnreadableOutput {
        name: Located<String>,
        material: Span,
        what: String,
    },
    #[error("`{graph}` takes no {kind} light")]
    Light {
        graph: String,
        kind: &'static str,
        takes: Vec<String>,
        place: Span,
    },
    #[error("`{graph}` is not proven on the backend {backend}, which has {lacks}")]
    NotProven {
        graph: String,
        backend: String,
        lacks: String,
        place: Span,
    },
    #[error("the viewport has no pixels")]
    NoViewport(Span),
    #[error("the size of `{}` is not known: no shader sees it", **.0)]
    UnsizedBuffer(Located<String>),
    #[error("the import `{}` was not made for what pass `{}` does", **name, **pass)]
    ImportUsage {
        name: Located<String>,
        pass: Located<String>,
        lacking: String,
    },
    #[error(
        "the materials of `{graph}` take {takes}, but there are only {limit} of memory for them"
    )]
    Memory {
        graph: String,
        takes: String,
        limit: String,
        table: String,
        largest: Option<Span>,
        place: Span,
    },
}

impl From<OutputError> for Diagnostic {
    fn from(mistake: OutputError) -> Self {
        let diagnostic = Self::error(mistake.code(), mistake.to_string());
        mistake.explain(diagnostic)
    }
}

impl OutputError {
    fn code(&self) -> Code {
        match self {
            Self::UnwrittenOutput { .. } => Code::ReadBeforeWrite,
            Self::UnreadableOutput { .. } => Code::FormatMismatch,
            Self::NoViewport(_) | Self::UnsizedBuffer(_) => Code::Size,
            Self::Light { .. } => Code::Light,
            Self::NotProven { .. } => Code::Feature,
            Self::ImportUsage { .. } => Code::Import,
            Self::Memory { .. } => Code::Memory,
            _ => Code::Output,
        }
    }

    fn explain(self, diagnostic: Diagnostic) -> Diagnostic {
        match self {
            Self::NoOutput { name, known, .. }
            | Self::NoMaterial { name, known, .. }
            | Self::NoPass { name, known } => diagnostic.suggest(&name, known),
            Self::Unsized(_) => diagnostic
                .help("its size is known only once it is built, and the copy is planned before"),
            Self::Provided(name) => {
                diagnostic.help(format!("name a pass that binds it: `{name}@PASS`"))
            }
            Self::Sampler(_) | Self::Unwritten(_) | Self::Unreadable { .. } => diagnostic,
            Self::UnwrittenOutput { material, .. } => diagnostic
                .at(
                    material.span.clone(),
                    format!("`{}` is never written", *material),
                )
                .help("let a pass write it, or name another `material`"),
            Self::UnreadableOutput { material, what, .. } => {
                let is_of_samples = what.contains("samples");
                diagnostic.at(material, what).help(if is_of_samples {
                    "name a texture of one sample that a `resolve` is written to"
                } else {
                    "use Depth32Float or Depth16Unorm"
                })
            }
            Self::Light { takes, place, .. } => diagnostic
                .at(place, "")
                .help(format!("it takes: {}", takes.join(", "))),
            Self::NotProven { backend, place, .. } => diagnostic.at(place, "").help(format!(
                "run it on another backend; a graph whose answers on this one are known to be \
                 right says `proven_on: [{backend}]`"
            )),
            Self::NoViewport(span) => diagnostic.at(span, ""),
            Self::UnsizedBuffer(name) => diagnostic
                .at(name.span, "")
                .help("let a pass bind it: the size of its items comes from the shader's type"),
            Self::ImportUsage {
                name,
                pass,
                lacking,
            } => diagnostic
                .at(name.span, "used here")
                .at(pass.span, "by this pass")
                .help(format!("the host must make it with {lacking} besides")),
            Self::Memory {
                table,
                largest,
                place,
                ..
            } => {
                let diagnostic = match largest {
                    Some(span) => diagnostic.at(span, "the largest of them"),
                    None => diagnostic.at(place, ""),
                };
                diagnostic.help(format!(
                    "make the largest ones smaller (a smaller viewport, the param that sizes \
                     them, fewer layers, a format with fewer bytes), or allow more memory\n{table}"
                ))
            }
        }
    }
}
