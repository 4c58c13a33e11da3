//! Edits of an extended document that cannot be made.

use crate::{
    diagnostics::{code::Code, diagnostic::Diagnostic, reports::IntoDiagnostic},
    language::name::Name,
    source::span::{Located, Span},
};

#[derive(Clone, Debug, thiserror::Error)]
pub(crate) enum EditError {
    #[error("the extended document has no entry `{}`", **path)]
    NoSuchEntry {
        path: Located<String>,
        name: String,
        known: Vec<String>,
    },
    #[error("`Remove` takes out passes alone")]
    RemovesItem(Span),
    #[error("`narrow` brings back the word `{}` of `{}`", **word, **name)]
    Widens {
        name: Located<String>,
        word: Located<Name>,
        first: Span,
    },
    #[error("`{}` stands behind the interface of `{entry}`", **path)]
    Behind {
        path: Located<String>,
        entry: String,
    },
    #[error("a new `{}` needs a place", **.0)]
    NoPlace(Located<String>),
    #[error("a new `{}` has several places", **.0)]
    TwoPlaces(Located<String>),
    #[error("`{}` does not say which entry it is about", **.0)]
    NoPath(Located<String>, &'static str),
    #[error("an entry is named in quotes")]
    NoString(Span),
    #[error("`{1}` has no such field")]
    Field(Located<String>, &'static str),
    #[error("the entries of a group are changed one by one")]
    Passes(Span),
    #[error("`{}` edits an extended document, and this one extends none", **.0)]
    NotExtending(Located<String>),
    #[error("the document extends itself")]
    Cycle(Span, Vec<String>),
}

impl IntoDiagnostic for EditError {
    fn code(&self) -> Code {
        match self {
            Self::Cycle(..) => Code::IncludeCycle,
            _ => Code::Edit,
        }
    }

    fn explain(self, diagnostic: Diagnostic) -> Diagnostic {
        const PLACES: &str = "say `before`, `after` or `instead: \"entry\"`; without one, an entry \
            stands behind the new one above it";
        match self {
            Self::NoSuchEntry { path, name, known } => {
                diagnostic.at(path.span, "").suggest(&name, known)
            }
            Self::RemovesItem(span) => diagnostic.at(span, "").help(
                "leave it out: what the extended document declares goes by itself once nothing \
                 uses it",
            ),
            Self::Widens { word, first, .. } => diagnostic
                .at(word.span, "widened here")
                .at(first, "narrowed by the extended document")
                .help("`narrow` only takes words away: leave it out"),
            Self::Behind { path, entry } => diagnostic.at(path.span, "").help(format!(
                "change the `graph` of `{entry}`; the new document may extend the old one"
            )),
            Self::NoPlace(tag) | Self::TwoPlaces(tag) => diagnostic.at(tag.span, "").help(PLACES),
            Self::NoPath(tag, field) => {
                diagnostic.at(tag.span, format!("give it `{field}: \"entry\"`"))
            }
            Self::NoString(span) => diagnostic.at(span, "for example `\"group.pass\"`"),
            Self::Field(name, _) => diagnostic.at(name.span, "not a field of this"),
            Self::Passes(span) => diagnostic
                .at(span, "")
                .help("name them by their paths: `pass: \"group.pass\"`"),
            Self::NotExtending(word) => diagnostic
                .at(word.span, "")
                .help("begin the document with `extends: \"other.ron\"`"),
            Self::Cycle(span, files) => diagnostic
                .at(span, "extends it again")
                .help(format!("the cycle is {}", files.join(" → "))),
        }
    }
}
