//! Mistakes in expressions and references.

use crate::{
    diagnostics::{code::Code, diagnostic::Diagnostic},
    language::{
        name::NameFault,
        syntax::{Attribute, Function},
    },
    source::span::{Located, Span},
};

/// An expression or reference that cannot be read.
#[derive(Clone, Debug, thiserror::Error)]
pub(crate) enum SyntaxFault {
    #[error("`{1}` has no meaning here")]
    Sign(Span, char),
    #[error("`{}` is not a number", text(.0))]
    Number(Span),
    #[error("the expression is too long")]
    TooLong(Span, usize),
    #[error("{expected} is expected, not {found}")]
    Unexpected {
        span: Span,
        found: String,
        expected: String,
    },
    #[error("`{}` is not a name", text(.0))]
    Name(Span, NameFault),
    #[error("unknown function `{}`", **.0)]
    Function(Located<String>),
    #[error("wgpu has no feature `{}`", **.0)]
    Feature(Located<String>),
    #[error("`{function}` takes {expected} arguments, not {found}")]
    Arguments {
        span: Span,
        function: &'static str,
        expected: usize,
        found: usize,
    },
    /// End of a reference that stands elsewhere, or in an expression.
    #[error("`{}` does not stand here", text(.0))]
    Part(Span, &'static str),
    #[error("strings of the language have no escapes")]
    Escape(Span),
}

fn text(span: &Span) -> &str {
    span.file.text.get(span.range.clone()).unwrap_or("")
}

impl From<SyntaxFault> for Diagnostic {
    fn from(mistake: SyntaxFault) -> Self {
        let diagnostic = Self::error(mistake.code(), mistake.to_string());
        mistake.explain(diagnostic)
    }
}

impl SyntaxFault {
    fn code(&self) -> Code {
        match self {
            Self::Name(..) => Code::Name,
            Self::Feature(_) => Code::Feature,
            _ => Code::Expression,
        }
    }

    fn explain(self, diagnostic: Diagnostic) -> Diagnostic {
        match self {
            Self::Sign(span, _) | Self::Number(span) => diagnostic.at(span, "here"),
            Self::TooLong(span, most) => diagnostic
                .at(span, "")
                .help(format!("an expression has at most {most} words and signs")),
            Self::Unexpected { span, .. } | Self::Arguments { span, .. } => {
                diagnostic.at(span, "here")
            }
            Self::Name(span, fault) => diagnostic.at(span, fault.to_string()),
            Self::Function(name) => {
                let known = Function::ALL.iter().map(|(name, ..)| *name).chain(["has"]);
                diagnostic.at(name.span.clone(), "").suggest(&name, known)
            }
            Self::Feature(name) => {
                let known = wgt::Features::all();
                let known = known.iter_names().map(|(name, _)| name);
                diagnostic.at(name.span.clone(), "").suggest(&name, known)
            }
            Self::Part(span, "number") => diagnostic
                .at(span, "a part of a material is not a number")
                .help(format!("ask for an attribute of it: {}", attributes())),
            Self::Part(span, "attribute") => {
                diagnostic.at(span, "an attribute, where a material is named")
            }
            Self::Part(span, "mip") => {
                diagnostic.at(span, "`.mip[…]` follows the name of a material")
            }
            Self::Part(span, _) => diagnostic.at(
                span,
                "`.previous` and `.mip[…]` end a reference, in this order",
            ),
            Self::Escape(span) => diagnostic
                .at(span, "`\\` here")
                .help("write the signs themselves"),
        }
    }
}

/// The attributes in a sentence.
pub(crate) fn attributes() -> String {
    let names: Vec<String> = Attribute::ALL
        .iter()
        .filter(|(_, attribute)| *attribute != Attribute::Index)
        .map(|(name, _)| format!("`.{name}`"))
        .collect();
    names.join(", ")
}
