//! Expressions that have no value.

use super::language::attributes;
use crate::{
    diagnostics::{code::Code, diagnostic::Diagnostic},
    language::{
        name::Name,
        value::{Scalar, Value},
    },
    source::span::{Located, Span},
};

/// An expression without a value, or with one of the wrong type.
#[derive(Clone, Debug, thiserror::Error)]
pub(crate) enum EvaluationError {
    #[error("{expected} is needed here, not {}", found.describe())]
    Type {
        span: Span,
        expected: &'static str,
        found: Value,
    },
    #[error("{} numbers do not go with {}", lengths[0], lengths[1])]
    Lengths { span: Span, lengths: [usize; 2] },
    #[error("{1} is less than nothing")]
    Negative(Span, i64),
    #[error("{1} is more than 32 bits hold")]
    Large(Span, u64),
    #[error("this divides by zero")]
    DivisionByZero(Span),
    #[error("the result is larger than a number can be")]
    Overflow(Span),
    #[error("`{word}` is not one of the words")]
    NoSuchWord {
        span: Span,
        word: String,
        words: Vec<Name>,
    },
    #[error("{}", match found {
        Value::Word(_) => "not every word of this Choice may stand here".to_owned(),
        found => format!("a word is needed here, not {}", found.describe()),
    })]
    Words {
        span: Span,
        expected: Vec<String>,
        found: Value,
    },
    #[error("{of} has no such attribute")]
    NoAttribute { span: Span, of: String },
    #[error("`{}` has no number of items", **.0)]
    NoCount(Located<String>),
    #[error("it is not known how many items `{}` has", **.0)]
    Uncounted(Located<String>),
    #[error("`{}`: its size is that of itself", **.0)]
    Circular(Located<String>),
    #[error("`{}` is made of itself", .0.first().map_or("", |name| name.as_str()))]
    CircularValue(Vec<Located<String>>),
    #[error("values are made of each other more than {most} deep at `{}`", **name)]
    DeepValue { name: Located<String>, most: usize },
    /// An index where nothing is repeated; of a group or include, if one is named.
    #[error("nothing is repeated here")]
    NoIndex(Span, Option<Name>),
    #[error("`{1}` has no size here: only params and features have values")]
    NoSizes(Span, String),
    #[error("no shader's constant can stand here")]
    NoShader(Span),
    #[error("`{file}` has no scalar constant `{name}`")]
    NoConstant {
        span: Span,
        file: String,
        name: String,
        known: Vec<String>,
    },
    #[error("{what}")]
    Unknown {
        span: Span,
        what: String,
        word: String,
        known: Vec<String>,
    },
}

impl EvaluationError {
    /// A name in an expression that is no param.
    pub fn param(name: &str, span: &Span, is_material: bool, known: Vec<String>) -> Self {
        Self::Unknown {
            span: span.clone(),
            what: if is_material {
                format!("`{name}` is a material: name an attribute of it, `{name}.size`")
            } else {
                format!("unknown param `{name}`")
            },
            word: name.to_owned(),
            known: if is_material { Vec::new() } else { known },
        }
    }
}

impl From<EvaluationError> for Diagnostic {
    fn from(mistake: EvaluationError) -> Self {
        let diagnostic = Self::error(mistake.code(), mistake.to_string());
        mistake.explain(diagnostic)
    }
}

impl EvaluationError {
    fn code(&self) -> Code {
        match self {
            Self::Unknown { .. } => Code::UnknownParam,
            Self::Circular(_) | Self::NoCount(_) | Self::Uncounted(_) => Code::Size,
            Self::CircularValue(_) | Self::DeepValue { .. } => Code::Value,
            _ => Code::Expression,
        }
    }

    fn explain(self, diagnostic: Diagnostic) -> Diagnostic {
        match self {
            Self::Type {
                span,
                expected,
                found,
            } => {
                let diagnostic = diagnostic.at(span, format!("this is {found}"));
                match (expected.contains("whole"), found) {
                    (true, Value::Scalar(Scalar::Number(number))) if number.abs() < 1e9 => {
                        diagnostic.help("`floor(…)` and `ceil(…)` make a whole number of it")
                    }
                    _ => diagnostic,
                }
            }
            Self::Lengths { span, .. } => diagnostic
                .at(span, "here")
                .help("name parts of the longer one, as `x.width` and `x.height`"),
            Self::Negative(span, _)
            | Self::Large(span, _)
            | Self::DivisionByZero(span)
            | Self::Overflow(span)
            | Self::NoSizes(span, _) => diagnostic.at(span, "here"),
            Self::NoSuchWord { span, word, words } => diagnostic.at(span, "").suggest(&word, words),
            Self::Words {
                span,
                expected,
                found,
            } => diagnostic
                .at(span, format!("this is {found}"))
                .help(format!(
                    "a Choice of these words may stand here, all of its words being among them: {}",
                    expected.join(", ")
                )),
            Self::NoAttribute { span, .. } => diagnostic
                .at(span, "")
                .help(format!("attributes are {}", attributes())),
            Self::NoCount(name) => diagnostic
                .at(name.span, "it says no `count`")
                .help("give the buffer one, and its shaders an array of any length"),
            Self::Uncounted(name) => diagnostic
                .at(name.span, "its items are counted when it is built")
                .help("bind all of it, and let the shader ask for `arrayLength`"),
            Self::Circular(name) => diagnostic
                .at(name.span, "")
                .help("give one of these materials a size of its own"),
            Self::CircularValue(ring) => {
                let names: Vec<&str> = ring.iter().map(|name| name.as_str()).collect();
                let help = format!("the ring is {}", names.join(" → "));
                let places = ring.iter().take(ring.len() - 1);
                let diagnostic = places.fold(diagnostic, |diagnostic, name| {
                    diagnostic.at(name.span.clone(), "asks for the next")
                });
                diagnostic.help(help)
            }
            Self::DeepValue { name, .. } => diagnostic.at(name.span, "").help("use fewer steps"),
            Self::NoIndex(span, None) => diagnostic
                .at(span, "`index` is that of a repetition")
                .help("write a number, or `repeat: …`"),
            Self::NoIndex(span, Some(name)) => diagnostic.at(
                span,
                format!("no repeated entry around this is called `{name}`"),
            ),
            Self::NoShader(span) => diagnostic
                .at(span, "names in capitals are constants of a pass's shader")
                .help("use a param, which is written in small letters"),
            Self::NoConstant {
                span, name, known, ..
            } => diagnostic
                .at(span, "")
                .suggest(&name, known)
                .help("a constant that a document asks for has a type: `const NAME: u32 = …;`"),
            Self::Unknown {
                span, word, known, ..
            } => diagnostic.at(span, "").suggest(&word, known),
        }
    }
}
