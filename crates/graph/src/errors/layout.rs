//! Buffers whose size or layout does not fit.

use crate::{
    diagnostics::{code::Code, diagnostic::Diagnostic},
    source::span::{Located, Span},
};

#[derive(Clone, Debug, thiserror::Error)]
pub(crate) enum LayoutError {
    #[error("two shaders see `{name}` with different layouts")]
    Disagreement {
        name: String,
        layouts: [String; 2],
        spans: [Span; 2],
    },
    #[error("`{name}` has items of {stride} bytes")]
    Provided {
        name: String,
        stride: u64,
        layout: String,
        span: Span,
    },
    #[error("the import `{name}` has {have} bytes, {needed} are needed")]
    Import {
        name: String,
        have: u64,
        needed: u64,
        span: Span,
    },
    #[error("`{name}` does not say how many items it has")]
    NoCount {
        name: String,
        span: Span,
        declared: Option<Span>,
    },
    #[error("the `count` of `{name}` has no effect")]
    IgnoredCount {
        name: String,
        span: Span,
        declared: Option<Span>,
    },
    #[error("`{name}` needs {bytes} bytes, more than the adapter can bind")]
    TooLarge {
        name: String,
        bytes: u64,
        most: u64,
        declared: Option<Span>,
    },
    #[error("the items of `{name}` that are bound here have {have} bytes, the shader's {needed}")]
    Item {
        name: String,
        have: u64,
        needed: u64,
        span: Span,
    },
    #[error("items of `{name}` are {stride} bytes apart, and cannot be bound alone")]
    Alignment {
        name: String,
        stride: u64,
        alignment: u64,
        span: Span,
    },
    #[error("`{}` cannot be copied onto `{}`: they differ in size", **from, **to)]
    Copy {
        from: Located<String>,
        to: Located<String>,
        bytes: [u64; 2],
    },
    #[error("the data of `{name}` do not fit its shader: {what}")]
    Data {
        name: String,
        what: String,
        span: Span,
        declared: Option<Span>,
    },
}

impl From<LayoutError> for Diagnostic {
    fn from(mistake: LayoutError) -> Self {
        let diagnostic = Self::error(mistake.code(), mistake.to_string());
        mistake.explain(diagnostic)
    }
}

impl LayoutError {
    fn code(&self) -> Code {
        match self {
            Self::NoCount { .. } | Self::TooLarge { .. } | Self::Copy { .. } => Code::Size,
            Self::IgnoredCount { .. } => Code::Size,
            Self::Alignment { .. } => Code::Alignment,
            _ => Code::LayoutMismatch,
        }
    }

    fn explain(self, diagnostic: Diagnostic) -> Diagnostic {
        let at = |diagnostic: Diagnostic, span: Option<Span>, text: &str| match span {
            Some(span) => diagnostic.at(span, text),
            None => diagnostic,
        };
        match self {
            Self::Disagreement {
                layouts: [first, other],
                spans: [at_first, at_other],
                ..
            } => diagnostic
                .at(at_other, format!("here it is {other}"))
                .at(at_first, format!("here it is {first}"))
                .help("declare the item type once, in a shared module that both import"),
            Self::Provided { layout, span, .. } => {
                diagnostic.at(span, format!("the shader sees {layout}"))
            }
            Self::Import { span, .. } => diagnostic.at(span, "needed here"),
            Self::NoCount { span, declared, .. } => at(
                diagnostic.at(span, "this shader sees an array of any length"),
                declared,
                "give it a `count`",
            ),
            Self::IgnoredCount { span, declared, .. } => {
                at(diagnostic, declared, "leave `count` out here")
                    .at(span, "this shader sees a fixed size")
            }
            Self::TooLarge { most, declared, .. } => {
                at(diagnostic, declared, "").help(format!("its limit is {most} bytes"))
            }
            Self::Item { span, .. } => diagnostic
                .at(span, "seen here")
                .help("let another shader see the buffer as an array of such items"),
            Self::Alignment {
                alignment, span, ..
            } => diagnostic.at(span, "bound here").help(format!(
                "a multiple of {alignment} is needed, which `@size({alignment})` on a member of \
                 the item gives"
            )),
            Self::Copy { from, to, bytes } => diagnostic
                .at(from.span, format!("{} bytes", bytes[0]))
                .at(to.span, format!("{} bytes", bytes[1]))
                .help("give both the same `count`"),
            Self::Data { span, declared, .. } => {
                at(diagnostic, declared, "").at(span, "this shader sees it")
            }
        }
    }
}
