//! Mistakes between documents: params, inputs, outputs, names.

use crate::{
    diagnostics::{code::Code, diagnostic::Diagnostic, reports::IntoDiagnostic},
    param::{Param, ParamFault, ParamValue},
    source::span::{Located, Span},
};

/// A param that has no value, or a wrong one.
#[derive(Clone, Debug, thiserror::Error)]
pub(crate) enum ParamError {
    #[error("{0}")]
    Unknown(String),
    #[error("param `{}` = {value}: {why}", **name)]
    Asked {
        name: Located<String>,
        value: ParamValue,
        why: ParamFault,
    },
    #[error("a word of a Choice stands without quotes")]
    QuotedWord { word: String, span: Span },
    #[error("the default of param `{}` does not fit", **param)]
    Default {
        param: Located<String>,
        why: ParamFault,
    },
    #[error("the value for param `{}` does not fit", **name)]
    Set {
        name: Located<String>,
        declared: Span,
        why: ParamFault,
    },
    #[error(
        "`{}` ({}) is handed to `{}` ({})", *outer.name, range(outer), **name, range(param)
    )]
    Misfit {
        name: Located<String>,
        outer: Box<Param>,
        param: Box<Param>,
    },
    #[error("`{document}` asks for the param `{name}`")]
    Required {
        name: String,
        document: String,
        span: Span,
        declared: Span,
    },
}

/// Type and range of a param.
fn range(param: &Param) -> String {
    let ty = &param.ty;
    match (param.min, param.max) {
        (Some(min), Some(max)) => format!("{ty}, {min} to {max}"),
        (Some(min), None) => format!("{ty}, {min} at least"),
        (None, Some(max)) => format!("{ty}, {max} at most"),
        (None, None) => ty.to_string(),
    }
}

impl IntoDiagnostic for ParamError {
    fn code(&self) -> Code {
        match self {
            Self::Unknown(_) => Code::UnknownParam,
            _ => Code::ParamValue,
        }
    }

    fn explain(self, diagnostic: Diagnostic) -> Diagnostic {
        match self {
            Self::Unknown(_) => diagnostic,
            Self::Asked { name, .. } => diagnostic.at(name.span, "declared here"),
            Self::Default { param, why } => diagnostic.at(param.span, why.to_string()),
            Self::QuotedWord { word, span } => diagnostic
                .at(span, "in quotes this is an expression")
                .help(format!("write `default: {word}`")),
            Self::Set {
                name,
                declared,
                why,
            } => diagnostic
                .at(name.span, why.to_string())
                .at(declared, "declared here"),
            Self::Misfit { name, outer, param } => diagnostic
                .at(name.span, "given here")
                .at(outer.name.span.clone(), range(&outer))
                .at(param.name.span.clone(), range(&param))
                .help(
                    "give the first one the type and the `min` and `max` of the other, or `set` \
                     that to an expression that fits",
                ),
            Self::Required {
                name,
                span,
                declared,
                ..
            } => diagnostic
                .at(span, "no param here has this name")
                .at(declared, "it has no default")
                .help(format!(
                    "declare one, or give it a value: `set: {{\"{name}\": …}}`"
                )),
        }
    }
}

/// Mistakes at the border between two documents.
#[derive(Clone, Debug, thiserror::Error)]
pub(crate) enum InterfaceError {
    /// Two includes of one content, between which a pass writes what they read or write.
    #[error("`{graph}` runs twice, because `{pass}` writes `{material}` in between")]
    TwoCopies {
        graph: String,
        pass: String,
        material: String,
        span: Span,
        by: Span,
    },
    #[error("`{}` is a value, not a material", **.0)]
    IsValue(Located<String>),
    #[error("`{document}` asks for `{name}`, {kind}")]
    NoInput {
        document: String,
        name: String,
        kind: String,
        span: Span,
        declared: Span,
        known: Vec<String>,
    },
    #[error("the host imports no `{}`, which the document asks for", **.0)]
    NoImport(Located<String>),
    #[error("`{document}` asks for `{name}`, {expected}; here it is {found}")]
    WrongInput {
        document: String,
        name: String,
        expected: String,
        found: String,
        span: Span,
        declared: Span,
    },
    #[error("the host imports {found} for `{}`, {expected} is asked for", **name)]
    WrongImport {
        name: Located<String>,
        expected: String,
        found: String,
    },
    #[error("the input `{}` is written, but is not an output", **.0)]
    WrittenInput(Located<String>, Span),
    #[error("`{document}` has no input, output or param `{}`", **name)]
    Unused {
        document: String,
        name: Located<String>,
        known: Vec<String>,
    },
    #[error("nothing in the group `{group}` asks for `{}`", **name)]
    UnusedInGroup {
        group: String,
        name: Located<String>,
    },
    #[error("no pass writes the output `{}`", **.0)]
    UnwrittenOutput(Located<String>),
    #[error("the output `{}` cannot be written into a material here", **name)]
    BoundOutput {
        name: Located<String>,
        why: String,
        declared: Span,
    },
    #[error("unknown material `{}`", **name)]
    Unknown {
        name: Located<String>,
        /// File in which the name stands.
        document: String,
        known: Vec<String>,
    },
    #[error("`{entry}` gives no `{}`", **name)]
    Private {
        entry: String,
        name: Located<String>,
        known: Vec<String>,
    },
    #[error("`{}` has no content of its own", **.0)]
    Namespace(Located<String>),
    #[error("`{text}` does not exist")]
    Range {
        text: String,
        span: Span,
        what: String,
        declared: Option<Span>,
    },
    #[error("`{text}` has no such part")]
    NoPart {
        text: String,
        span: Span,
        what: &'static str,
    },
    #[error("`{of}` is a material, and gives no `{}`", **name)]
    NotOfMaterial { of: String, name: Located<String> },
    #[error("`{name}` has no version of the frame before")]
    NoPrevious {
        name: String,
        span: Span,
        what: String,
        /// The material, if it is one with `keep: true`.
        kept: Option<String>,
    },
    #[error("the graph has more than {most} {what}")]
    TooMany {
        most: usize,
        what: &'static str,
        at: Span,
    },
    #[error("`{document}` cannot run without the feature `{}`", **feature)]
    Feature {
        document: String,
        feature: Located<String>,
    },
}

impl IntoDiagnostic for InterfaceError {
    fn code(&self) -> Code {
        match self {
            Self::NoInput { .. }
            | Self::NoImport(_)
            | Self::WrongInput { .. }
            | Self::WrongImport { .. }
            | Self::WrittenInput(..) => Code::Input,
            Self::Unused { .. } | Self::UnusedInGroup { .. } => Code::Unused,
            Self::UnwrittenOutput(_) | Self::BoundOutput { .. } => Code::Output,
            Self::TwoCopies { .. } => Code::TwoCopies,
            Self::Unknown { .. } | Self::Private { .. } => Code::UnknownResource,
            Self::Namespace(_)
            | Self::NoPart { .. }
            | Self::NotOfMaterial { .. }
            | Self::IsValue(_)
            | Self::NoPrevious { .. } => Code::ResourceKind,
            Self::Range { .. } => Code::Range,
            Self::TooMany { .. } => Code::Size,
            Self::Feature { .. } => Code::Feature,
        }
    }

    fn explain(self, diagnostic: Diagnostic) -> Diagnostic {
        match self {
            Self::NoInput {
                name,
                span,
                declared,
                known,
                ..
            } => diagnostic
                .at(span, "nothing here has this name")
                .at(declared, "asked for here")
                .suggest(&name, known)
                .help(format!("bind what is meant: `bind: {{\"{name}\": \"…\"}}`")),
            Self::TwoCopies { span, by, .. } => diagnostic
                .at(span, "the second copy")
                .at(by, "written by this pass")
                .help(
                    "put the include above that pass, or give it a name, which says that two \
                     are meant",
                ),
            Self::IsValue(name) => diagnostic.at(name.span, "a material is meant here").help(
                "values stand in expressions, and in params and overrides of shaders by name",
            ),
            Self::NoImport(name) => diagnostic
                .at(
                    name.span,
                    "an input of the root document is the host's import",
                )
                .help("include the document in one that has it, or let the host import it"),
            Self::WrongInput { span, declared, .. } => diagnostic
                .at(span, "given here")
                .at(declared, "asked for here"),
            Self::WrongImport { name, .. } => diagnostic.at(name.span, "asked for here"),
            Self::WrittenInput(name, by) => diagnostic
                .at(name.span.clone(), "an input")
                .at(by, "written here")
                .help(format!(
                    "name it among the `outputs`, so that its includers know; or make it a \
                     material, and take the input of an extended document out: \
                     `inputs: [Remove(name: \"{}\")]`",
                    *name
                )),
            Self::Unused { name, known, .. } => {
                diagnostic.at(name.span.clone(), "").suggest(&name, known)
            }
            Self::UnusedInGroup { name, .. } => diagnostic
                .at(name.span, "")
                .help("one of its passes or includes must have this name free; check its spelling"),
            Self::UnwrittenOutput(name) => diagnostic
                .at(name.span, "")
                .help("let a pass write it, or name another `material`"),
            Self::BoundOutput {
                name,
                why,
                declared,
            } => diagnostic.at(name.span, why).at(declared, "declared here"),
            Self::Unknown {
                name,
                document,
                known,
            } => {
                let label = format!("`{document}` declares no material or input of this name");
                diagnostic
                    .at(name.span.clone(), label)
                    .suggest(&name, known)
            }
            Self::Private { name, known, .. } => diagnostic
                .at(name.span.clone(), "only its outputs are seen from here")
                .suggest(&name, known),
            Self::TooMany { at, .. } => diagnostic
                .at(at, "counted up to here")
                .help("repeat or include less"),
            Self::Feature { feature, .. } => diagnostic
                .at(feature.span, "the device does not have this feature")
                .help("run it on an adapter that has the feature, or ask `has(…)` in an `if`"),
            other => other.explain_part(diagnostic),
        }
    }
}

impl InterfaceError {
    /// Parts and versions that there are not.
    fn explain_part(self, diagnostic: Diagnostic) -> Diagnostic {
        match self {
            Self::Namespace(name) => diagnostic.at(
                name.span,
                "name what it gives: `x.y`, or `x[0].y` where it is repeated",
            ),
            Self::Range {
                span,
                what,
                declared,
                ..
            } => {
                let diagnostic = diagnostic.at(span, what);
                match declared {
                    Some(declared) => diagnostic.at(declared, "declared here"),
                    None => diagnostic,
                }
            }
            Self::NoPart { span, what, .. } => diagnostic.at(span, what),
            Self::NotOfMaterial { of, name } => diagnostic.at(name.span, "not a part of it").help(
                format!("its parts are `{of}[0]`, `{of}.mip[0]`, `{of}.previous`"),
            ),
            Self::NoPrevious {
                span, what, kept, ..
            } => diagnostic
                .at(span, format!("it is {what}"))
                .help(match kept {
                    Some(name) => format!(
                        "read `{name}` above the passes that write it: there it holds what the \
                         frame before left; or leave `keep` out"
                    ),
                    None => "textures and buffers that the graph writes have one; copy it into one"
                        .to_owned(),
                }),
            _ => diagnostic,
        }
    }
}
