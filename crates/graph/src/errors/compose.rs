//! Documents that cannot be found, or do not go together.

use crate::{
    diagnostics::{code::Code, diagnostic::Diagnostic},
    source::span::{Located, Span},
};

#[derive(Clone, Debug, thiserror::Error)]
pub(crate) enum ComposeError {
    #[error("document `{0}` not found")]
    NoDocument(String, Option<String>),
    #[error("the document `{0}` cannot be read: {1}")]
    Unreadable(String, String),
    #[error("the document `{}` lies outside the folders of documents", **.0)]
    Outside(Located<String>),
    /// Where it was looked for, and what it may have been meant to be.
    #[error("document `{}` not found", **.0)]
    NoInclude(Located<String>, Vec<String>, Option<String>),
    #[error("the document `{}` cannot be read", **.0)]
    UnreadableInclude(Located<String>, String),
    #[error("the document `{}` includes itself", open.first().map_or("", |(path, _)| path))]
    Cycle {
        graph: Located<String>,
        open: Vec<(String, Option<Span>)>,
    },
    #[error("documents include or extend each other more than {1} deep")]
    TooDeep(Located<String>, usize),
    #[error("{}", same_name(name, known, what))]
    Clash {
        what: &'static str,
        name: String,
        known: String,
        span: Span,
        first: Span,
    },
    #[error("`{document}` has no param `{}`", **name)]
    NoParam {
        name: Located<String>,
        document: String,
        known: Vec<String>,
    },
    #[error("`{document}` has no open include `{name}`")]
    NoOpening {
        name: String,
        document: String,
        known: Vec<String>,
    },
    #[error("no light is taken both here and by `{}`", **graph)]
    NoCommonLight {
        graph: Located<String>,
        takes: Vec<String>,
    },
    #[error("`{}` is a param here already", **name)]
    ExposedTwice { name: Located<String>, first: Span },
    #[error("`{}` is not a `Choice`: it has no words to narrow", **name)]
    NarrowOfOther {
        name: Located<String>,
        declared: Span,
    },
    #[error("`{}` is not a word that is left to narrow", **word)]
    NarrowWord {
        word: Located<String>,
        declared: Span,
        known: Vec<String>,
    },
    #[error("the value `{}` has the name of a word of the param `{param}`", **name)]
    ValueIsWord {
        name: Located<String>,
        param: String,
        declared: Span,
    },
    #[error("`{}` cannot be exposed: its default is made of other params", **.0)]
    ExposedDefault(Located<String>),
    #[error("the document has no outputs, so none of its passes is needed")]
    NoOutputs(Span),
    #[error("nothing uses the {} `{}`", what.word(), **name)]
    Unused { what: Unused, name: Located<String> },
}

/// Part of a document that nothing uses.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Unused {
    Value,
    Material,
    Param,
    Import,
}

impl Unused {
    fn word(self) -> &'static str {
        match self {
            Self::Value => "value",
            Self::Material => "material",
            Self::Param => "param",
            Self::Import => "import",
        }
    }

    fn way_out(self) -> &'static str {
        match self {
            Self::Value => {
                "remove it, or check the names in expressions, outputs, params and overrides"
            }
            Self::Material => {
                "remove it, or check the names of the shader globals that should be it"
            }
            Self::Param => {
                "remove it, or check the names in `params` of the shaders and in expressions"
            }
            Self::Import => "remove the entry, or name the module as the shaders import it",
        }
    }
}

/// Describes a clash of two names.
fn same_name(name: &str, known: &str, what: &str) -> String {
    if name == known {
        format!("two of the name `{name}`: every {what} needs its own")
    } else {
        format!("`{name}` and `{known}` are one name in a shader")
    }
}

impl From<ComposeError> for Diagnostic {
    fn from(mistake: ComposeError) -> Self {
        let diagnostic = Self::error(mistake.code(), mistake.to_string());
        mistake.explain(diagnostic)
    }
}

impl ComposeError {
    fn code(&self) -> Code {
        match self {
            Self::Cycle { .. } => Code::IncludeCycle,
            Self::TooDeep(..) => Code::Size,
            Self::Clash { name, known, .. } if name != known => Code::Name,
            Self::Clash { .. } => Code::DuplicateName,
            Self::NoParam { .. } => Code::UnknownParam,
            Self::ExposedTwice { .. } | Self::ExposedDefault(_) => Code::ParamValue,
            Self::NoOpening { .. } => Code::UnknownParam,
            Self::NoCommonLight { .. } => Code::Light,
            Self::NoOutputs(_) => Code::Output,
            Self::Unused { .. } => Code::Unused,
            Self::NarrowWord { .. } | Self::NarrowOfOther { .. } => Code::ParamValue,
            Self::ValueIsWord { .. } => Code::Name,
            _ => Code::MissingFile,
        }
    }

    fn explain(self, diagnostic: Diagnostic) -> Diagnostic {
        match self {
            Self::NoDocument(_, None) | Self::Unreadable(..) => diagnostic,
            Self::NoDocument(_, Some(likeness)) => diagnostic.help(likeness),
            Self::Outside(graph) => diagnostic.at(graph.span, "asked for here").help(
                "documents stand beside the one that asks for them, in a folder below it, or in \
                 pipelines/, and are named without folder signs like `..`",
            ),
            Self::NoInclude(graph, candidates, likeness) => {
                let likeness = likeness.map_or(String::new(), |likeness| format!("; {likeness}"));
                let looked = format!("looked for {}{likeness}", candidates.join(", "));
                diagnostic.at(graph.span, "asked for here").help(looked)
            }
            Self::UnreadableInclude(path, why) => {
                diagnostic.at(path.span, "asked for here").help(why)
            }
            Self::Cycle { graph, open } => {
                let mut diagnostic = diagnostic.at(graph.span, "includes it again");
                for (path, place) in open.iter().skip(1) {
                    if let Some(place) = place {
                        diagnostic = diagnostic.at(place.clone(), format!("includes `{path}`"));
                    }
                }
                let path: Vec<&str> = open.iter().map(|(path, _)| path.as_str()).collect();
                diagnostic.help(format!(
                    "the cycle is {} → {}: take one of these includes out",
                    path.join(" → "),
                    path.first().unwrap_or(&"")
                ))
            }
            Self::TooDeep(graph, _) => diagnostic.at(graph.span, "").help("use fewer levels"),
            Self::Clash {
                what,
                name,
                known,
                span,
                first,
            } => clash(diagnostic, what, [name, known], [span, first]),
            Self::NoParam { name, known, .. } => {
                diagnostic.at(name.span.clone(), "").suggest(&name, known)
            }
            Self::NoOpening { name, known, .. } => match &known[..] {
                [] => diagnostic.help("an include is left open by `open: \"…\"`; it has none"),
                _ => diagnostic.suggest(&name, known),
            },
            Self::NoCommonLight { graph, takes } => {
                diagnostic.at(graph.span, "included here").help(format!(
                    "it takes {}: take one of these in `lights`, or another document",
                    takes.join(", ")
                ))
            }
            Self::ExposedTwice { name, first } => diagnostic
                .at(name.span.clone(), "exposed here")
                .at(first, "and declared here")
                .help(format!(
                    "give the include a name, or `set` it to the one that is here: \
                     `set: {{\"{0}\": \"{0}\"}}`",
                    *name
                )),
            Self::ExposedDefault(name) => diagnostic
                .at(name.span, "")
                .help("declare a param here, and `set` it to that"),
            Self::NoOutputs(span) => diagnostic.at(span, "").help("add `outputs: [\"…\"]`"),
            Self::NarrowOfOther { name, declared } => diagnostic
                .at(name.span, "")
                .at(declared, "declared here")
                .help("give a number another `min` or `max` where it is declared"),
            Self::NarrowWord {
                word,
                declared,
                known,
            } => diagnostic
                .at(word.span.clone(), "")
                .at(declared, "declared here")
                .suggest(&word, known),
            Self::ValueIsWord { name, declared, .. } => diagnostic
                .at(name.span, "")
                .at(declared, "its words are declared here")
                .help("rename the value: beside the param its name would be the word"),
            Self::Unused { what, name } => diagnostic.at(name.span, "").help(what.way_out()),
        }
    }
}

fn clash(
    diagnostic: Diagnostic,
    what: &str,
    [name, known]: [String; 2],
    [span, first]: [Span; 2],
) -> Diagnostic {
    if name != known {
        return diagnostic
            .at(span, format!("gives `{name}`"))
            .at(first, "declared here")
            .help("rename one of them");
    }
    let diagnostic = diagnostic
        .at(span, "the second one")
        .at(first, "the first one");
    if what != "material" {
        return diagnostic;
    }
    diagnostic
        .help("an include can be given a name: `name: \"left\"` makes `left.x` of its output `x`")
}
