//! Documents that cannot be read.

use crate::{
    diagnostics::{code::Code, diagnostic::Diagnostic},
    language::name::{Name, NameFault, RESERVED},
    panics::Panicked,
    source::span::{Located, SourceFile, Span},
};

/// Mistakes in the text of a document.
#[derive(Clone, Debug, thiserror::Error)]
pub(crate) enum DocumentError {
    #[error("the file `{}` holds no document", .0.name)]
    NoDocument(SourceFile),
    #[error("the document does not say its format")]
    NoFormat(Span),
    #[error("documents of format {1} are not read")]
    Format(Span, u32),
    #[error("{1}")]
    Syntax(Span, String),
    /// A library's mistake, not the author's.
    #[error("ron panics while this is read: {}", .1.message)]
    Panicked(Span, Panicked),
    #[error("the text ends too early")]
    Ends(Span),
    #[error("values are nested too deep")]
    Nested(Span),
    #[error("unknown field `{}`", **.0)]
    UnknownField(Located<String>, Vec<String>),
    #[error("unknown word `{}`", **.0)]
    UnknownWord(Located<String>, Vec<String>),
    #[error("unknown pass kind `{}`", **.0)]
    UnknownKind(Located<String>, Vec<String>),
    #[error("unknown type of param `{}`", **.0)]
    UnknownParamType(Located<String>),
    #[error("unknown kind of material `{}`", **.0)]
    UnknownMaterial(Located<String>),
    #[error("the field `{1}` is missing")]
    MissingField(Span, String),
    #[error("the field `{1}` is given twice")]
    FieldTwice(Span, String),
    #[error("`{}` is given twice", **.0)]
    KeyTwice(Located<String>),
    #[error("two of the name `{name}`: every {what} needs its own")]
    Twice {
        what: &'static str,
        name: String,
        span: Span,
        first: Span,
    },
    #[error("an entry begins with its kind")]
    Untagged { span: Span, section: &'static str },
    #[error("the {what} has {count} entries, {most} is the most")]
    TooMany {
        what: &'static str,
        span: Span,
        count: usize,
        most: usize,
    },
    #[error("`{1}` is not a name: {2}")]
    Name(Span, String, NameFault),
    #[error("`{}` is a word of the language and names no material, group or include", **.0)]
    Reserved(Located<Name>),
    #[error("`{1}` is not a name: give the include one, `name: \"…\"`")]
    Unnamed(Span, String),
    #[error("`{1}` has no value")]
    BareWord(Span, String),
    #[error("`expose` is a list of names, or `All`")]
    Expose(Span),
    #[error("a name in quotes is needed here")]
    NoString(Span),
    #[error("a tuple of numbers is needed here")]
    NoTuple(Span),
    #[error("this is not a value of `load`")]
    Load(Span),
    #[error("a write mask is needed here")]
    WriteMask(Span),
    #[error("an area is four whole numbers: `(x, y, width, height)`")]
    Area(Span),
    #[error("the size of a pass is one number or two: `(width, height)`")]
    Canvas(Span),
    #[error("clearing knows no area")]
    ClearInArea { clear: Span, area: Span },
    #[error("a list of items is needed here")]
    Data(Span),
    #[error("an input's format is written out")]
    InputFormat(Span),
    #[error("the param `{}` cannot be: {why}", **name)]
    Param { name: Located<Name>, why: String },
}

/// The types of params, as documents write them.
pub(crate) const PARAM_TYPES: [&str; 8] = [
    "F32", "I32", "U32", "Bool", "Vec2", "Vec3", "Vec4", "Choice",
];

/// Returns an example of an entry of a section, and the kinds that it may have.
fn kinds(section: &str) -> (&'static str, &'static [&'static str]) {
    match section {
        "params" => ("for example `U32(name: \"…\", default: 1)`", &PARAM_TYPES),
        "passes" => ("for example `Compute(name: \"…\", …)`", &[]),
        _ => (
            "for example `Texture(name: \"…\", …)`",
            &["Texture", "Buffer", "Sampler"],
        ),
    }
}

impl From<DocumentError> for Diagnostic {
    fn from(mistake: DocumentError) -> Self {
        let diagnostic = Self::error(mistake.code(), mistake.to_string());
        mistake.explain(diagnostic)
    }
}

impl DocumentError {
    fn code(&self) -> Code {
        match self {
            Self::Format(..) => Code::FormatVersion,
            Self::UnknownField(..) => Code::UnknownField,
            Self::UnknownWord(..)
            | Self::UnknownKind(..)
            | Self::UnknownParamType(_)
            | Self::UnknownMaterial(_) => Code::UnknownVariant,
            Self::MissingField(..) | Self::NoFormat(_) => Code::MissingField,
            Self::FieldTwice(..) | Self::KeyTwice(_) | Self::Twice { .. } => Code::DuplicateName,
            Self::TooMany { .. } => Code::Size,
            Self::Name(..) | Self::Reserved(_) | Self::Unnamed(..) => Code::Name,
            Self::Param { .. } => Code::ParamValue,
            Self::Panicked(..) => Code::LibraryPanic,
            _ => Code::Syntax,
        }
    }

    fn explain(self, diagnostic: Diagnostic) -> Diagnostic {
        match self {
            Self::NoDocument(file) => {
                let line = file.text.lines().next().map_or(0, str::len);
                diagnostic
                    .at(file.span(0..line), "")
                    .help("begin with `(format: 3, …)`")
            }
            Self::NoFormat(span) => diagnostic.at(span, "").help("begin with `format: 3,`"),
            Self::Format(span, 1) => diagnostic.at(span, "").help(FORMAT_1),
            Self::Format(span, 2) => diagnostic.at(span, "").help(FORMAT_2),
            Self::Format(span, _) => diagnostic
                .at(span, "")
                .help("this version of Skiagraph reads `format: 3`"),
            Self::Panicked(span, panicked) => diagnostic
                .at(span, "this brings it about")
                .help(panicked.way_out()),
            Self::Ends(span) => diagnostic
                .at(span, "something is not closed")
                .help("check that every bracket and quote is closed"),
            Self::Nested(span) => diagnostic.at(span, "").help(
                "no document needs so many brackets in brackets: is one of them never closed?",
            ),
            Self::UnknownField(name, known) => diagnostic
                .at(name.span.clone(), "not a field of this")
                .suggest(&name, known),
            Self::UnknownWord(word, known) => diagnostic
                .at(
                    word.span.clone(),
                    "not one of the words that may stand here",
                )
                .suggest(&word, known),
            Self::UnknownKind(tag, known) => diagnostic
                .at(tag.span.clone(), "no pass kind of this name is registered")
                .suggest(&tag, known),
            Self::UnknownParamType(tag) => diagnostic
                .at(tag.span.clone(), "")
                .suggest(&tag, kinds("params").1),
            Self::UnknownMaterial(tag) => diagnostic
                .at(tag.span.clone(), "")
                .suggest(&tag, kinds("materials").1),
            Self::Untagged { span, section } => {
                let (example, known) = kinds(section);
                diagnostic.at(span, example).suggest("", known)
            }
            other => other.explain_value(diagnostic),
        }
    }
}

/// Changes since format 2, for its authors.
const FORMAT_2: &str = "this is format 3 (docs/authoring.md): write `format: 3`; `refused` of a \
    param is `narrow` of the document; shadow maps come from `shared/create_shadow_map.ron` and \
    their place from `shared/fit_map.ron`, which give `map_layers` and `map_is_projective`, too: \
    a shader that reads one layer must `narrow` the words pssm and tsm of `fit` away; the fit \
    `eye` is `camera`, `tighten` is `fit_to_receivers`, `focus` is `warp`; a shader `x_masked` is \
    `x` with `imports`";

/// Changes since format 1.
const FORMAT_1: &str = "this is format 3 (docs/authoring.md): a param is `U32(name: …)`, an \
    expression stands in quotes (`size: \"map_size\"`, `count: \"scene.indices.count\"`), \
    `\"x.previous\"` and `\"x.mip[1]\"` are references, included documents state `inputs` and \
    `outputs`, and `Include` has `name`, `bind`, `set` and `expose`";

impl DocumentError {
    /// Mistakes in a value.
    fn explain_value(self, diagnostic: Diagnostic) -> Diagnostic {
        match self {
            Self::Syntax(span, _) => diagnostic.at(span, "here"),
            Self::MissingField(span, _) => diagnostic.at(span, "it must be given here"),
            Self::FieldTwice(span, _) => diagnostic.at(span, "the second one"),
            Self::KeyTwice(key) => diagnostic.at(key.span, "the second one"),
            Self::Twice { span, first, .. } => diagnostic
                .at(span, "the second one")
                .at(first, "the first one"),
            Self::TooMany { span, .. } => diagnostic.at(span, "this one is too many").help(
                "let `repeat` say what is alike, or split the document and `Include` its parts",
            ),
            Self::Name(span, ..) => diagnostic.at(span, ""),
            Self::Reserved(name) => diagnostic.at(name.span, "").help(format!(
                "these words have a meaning of their own: {}",
                RESERVED.join(", ")
            )),
            Self::Expose(span) => diagnostic.at(span, "").help(
                "write `expose: [\"map_size\"]`, or `expose: All` for every param that is not set",
            ),
            Self::Unnamed(span, _) => diagnostic.at(span, "this would be its name"),
            Self::BareWord(span, _) => diagnostic.at(span, "").help(
                "an expression stands in quotes, `\"viewport.size / 2\"`; a word of a Choice has \
                 small letters",
            ),
            Self::NoString(span) => diagnostic.at(span, "for example `\"maps[2]\"`"),
            Self::NoTuple(span) => diagnostic.at(span, "for example `(1, 0)`"),
            Self::Load(span) => diagnostic
                .at(span, "")
                .help("write `Load`, `LoadIf(\"…\")`, `Clear(0)` or `Clear(r, g, b, a)`"),
            Self::WriteMask(span) => diagnostic
                .at(span, "")
                .help("write `rgb`, `true` or `false`"),
            Self::Area(span) | Self::Canvas(span) => diagnostic.at(span, ""),
            Self::ClearInArea { clear, area } => diagnostic
                .at(clear, "this would clear the whole target")
                .at(area, "and this is a part of it")
                .help("leave `load` out here, and put a `Clear` above this pass"),
            Self::Data(span) => diagnostic
                .at(span, "")
                .help("write `[0.2, 0.6]` or `[(1, 0), (0, 1)]`"),
            Self::InputFormat(span) => diagnostic
                .at(span, "")
                .help("leave `format` out where any will do"),
            Self::Param { name, .. } => diagnostic.at(name.span, ""),
            _ => diagnostic,
        }
    }
}
