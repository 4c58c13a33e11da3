//! Deserialisation of names, expressions, references and words in the fields of documents.
use crate::errors::document::DocumentError;
use crate::errors::language::SyntaxFault;
use crate::expressions::parser;
use crate::language::{Expr, ExprKind, Name, Reference, Scalar, Value};
use crate::source::{SourceFile, Span};
use serde::{Deserialize, Deserializer, de::DeserializeOwned};
use skiagraph_located_ron::reader::{raw, read, refuse};
use std::{cell::RefCell, ops::Range};

/// Implements `Deserialize` for a type by a function of a value's text and place.
macro_rules! by_text {
    ($type:ty, $read:expr) => {
        impl<'de> serde::Deserialize<'de> for $type {
            fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
                let (text, span) = skiagraph_located_ron::reader::raw(deserializer)?;
                let read: fn(&'de str, $crate::source::Span) -> Result<Self, D::Error> = $read;
                read(text, span)
            }
        }
    };
}
pub(crate) use by_text;

/// Reads a string of the language by its grammar; it must have no escapes.
fn parse<T, E: serde::de::Error>(
    (text, span): (&str, &Span),
    parse: impl FnOnce(&SourceFile, Range<usize>) -> Result<T, SyntaxFault>,
) -> Result<T, E> {
    let inner = text.strip_prefix('"');
    let inner = inner.and_then(|text| text.strip_suffix('"'));
    let inner = inner.ok_or_else(|| refuse(DocumentError::NoString(span.clone())))?;
    let start = span.range.start + 1;
    if let Some(at) = inner.find('\\') {
        let place = span.file.span(start + at..start + at + 1);
        return Err(refuse(SyntaxFault::Escape(place)));
    }
    parse(&span.file, start..start + inner.len()).map_err(refuse)
}

impl<'de> Deserialize<'de> for Name {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let (text, span) = raw(deserializer)?;
        // The words of a `Choice` have no quotes.
        let name = if text.starts_with('"') {
            read::<String, D::Error>(text)?
        } else {
            text.to_owned()
        };
        Name::new(&name).map_err(|fault| refuse(DocumentError::Name(span, name, fault)))
    }
}

/// Expressions and references in the fields of a pass kind, whose meaning only the kind knows.
#[derive(Clone, Debug, Default)]
pub(crate) struct Mentions {
    pub exprs: Vec<Expr>,
    pub references: Vec<Reference>,
}

thread_local! {
    static MENTIONS: RefCell<Mentions> = RefCell::default();
}

impl Mentions {
    /// Returns the expressions and references that were deserialised on this thread since the last
    /// call.
    pub fn take() -> Self {
        MENTIONS.take()
    }
}

by_text!(Reference, |text, span| {
    let reference: Self = parse((text, &span), parser::reference)?;
    MENTIONS.with_borrow_mut(|mentions| mentions.references.push(reference.clone()));
    Ok(reference)
});

by_text!(Expr, |text, span| {
    let literal = |value, span| Ok(Expr::new(ExprKind::Literal(value), span));
    match text.chars().next() {
        Some('"') => {
            let expr: Self = parse((text, &span), parser::expression)?;
            MENTIONS.with_borrow_mut(|mentions| mentions.exprs.push(expr.clone()));
            Ok(expr)
        }
        Some('(') => {
            let parts = span.list();
            let parts = parts.map_err(|_| refuse(DocumentError::NoTuple(span.clone())))?;
            let parts = parts.iter().map(|part| read(part.text()));
            Ok(Expr::new(
                ExprKind::Tuple(parts.collect::<Result<_, _>>()?),
                span,
            ))
        }
        _ if matches!(text, "true" | "false") => literal(Value::Bool(text == "true"), span),
        Some(first) if first.is_alphabetic() => match Name::new(text) {
            Ok(word) => Ok(Expr::new(ExprKind::Word(word), span)),
            Err(_) => Err(refuse(DocumentError::BareWord(span, text.to_owned()))),
        },
        _ => {
            let whole = text.replace('_', "").parse();
            let scalar = match whole {
                Ok(whole) => Scalar::Whole(whole),
                Err(_) => Scalar::Number(read(text)?),
            };
            literal(Value::Scalar(scalar), span)
        }
    }
});

/// Value of a field of a [`PassKind`](crate::PassKind) that takes one word of a fixed set, the enum
/// `T`: the word itself, or an expression that yields the word.
/// [`Lowering::word`](crate::Lowering::word) returns the word.
#[derive(Clone, Debug)]
pub enum Chosen<T> {
    /// A word, written without quotes.
    Word(T),
    /// An expression in quotes that yields a word, such as the name of a `Choice` param.
    Expr(Expr),
}

impl<'de, T: DeserializeOwned> Deserialize<'de> for Chosen<T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let (text, _) = raw(deserializer)?;
        if text.starts_with('"') {
            read(text).map(Self::Expr)
        } else {
            read(text).map(Self::Word)
        }
    }
}

/// Reads prose, which may be broken into lines: any white space is one space.
pub(crate) fn prose<'de, D: Deserializer<'de>>(deserializer: D) -> Result<String, D::Error> {
    let text = String::deserialize(deserializer)?;
    Ok(one_line(&text))
}

/// Prose without its line breaks.
pub(crate) fn one_line(text: &str) -> String {
    let words: Vec<&str> = text.split_whitespace().collect();
    words.join(" ")
}

/// An entry of which a string alone is the most important field: `color: ["image"]`.
pub(crate) fn short_or_long<T, L: DeserializeOwned, E: serde::de::Error>(
    (text, span): (&str, Span),
    long: impl FnOnce(L) -> T,
    short: impl FnOnce(Reference) -> T,
) -> Result<T, E> {
    match text.chars().next() {
        Some('"') => read(text).map(short),
        Some(first) if first.is_alphanumeric() => Err(refuse(DocumentError::NoString(span))),
        _ => read(text).map(long),
    }
}

/// Operation on an attachment before the first draw: `Load`, `LoadIf("index > 0")`, `Clear(v)` for
/// all channels, `Clear(r, g, b, a)`.
#[derive(Clone, Debug)]
pub(crate) enum Load {
    Clear(Vec<Expr>),
    /// `Load`.
    Keep,
    /// `LoadIf`: keeps what is there where the condition holds; else clears it, as an attachment is
    /// cleared that says nothing.
    KeepIf(Expr),
}

by_text!(Load, |text, span| {
    let unknown = || refuse(DocumentError::Load(span.clone()));
    let (tag, body) = span.variant().ok_or_else(unknown)?;
    let is_bare = text.len() == tag.len();
    let values = (!is_bare).then(|| body.list()).transpose();
    match (tag.as_str(), values.map_err(|_| unknown())?.as_deref()) {
        ("Load", None) => Ok(Self::Keep),
        ("LoadIf", Some([condition])) => read(condition.text()).map(Self::KeepIf),
        ("Clear", Some(values @ ([_] | [_, _, _, _]))) => {
            let values = values.iter().map(|value| read(value.text()));
            Ok(Self::Clear(values.collect::<Result<_, _>>()?))
        }
        _ => Err(unknown()),
    }
});

/// A comparison, true where the new value stands in this relation to the stored one.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub(crate) enum Compare {
    Never,
    #[default]
    Less,
    Equal,
    LessEqual,
    Greater,
    NotEqual,
    GreaterEqual,
    Always,
}

impl From<Compare> for wgt::CompareFunction {
    fn from(compare: Compare) -> Self {
        match compare {
            Compare::Never => Self::Never,
            Compare::Less => Self::Less,
            Compare::Equal => Self::Equal,
            Compare::LessEqual => Self::LessEqual,
            Compare::Greater => Self::Greater,
            Compare::NotEqual => Self::NotEqual,
            Compare::GreaterEqual => Self::GreaterEqual,
            Compare::Always => Self::Always,
        }
    }
}
