//! Values of expressions.

use super::name::Name;
use crate::provided_kind::ProvidedKind;
use std::{fmt, sync::Arc};

/// A number in an expression: a 64-bit integer or a 64-bit float.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Scalar {
    /// An integer.
    Whole(i64),
    /// A floating-point number, which may be integral, too: `2.0`.
    Number(f64),
}

impl Scalar {
    /// Returns the number as a 64-bit float; an integer beyond 2^53 is rounded.
    pub fn number(self) -> f64 {
        match self {
            Self::Whole(whole) => whole as f64,
            Self::Number(number) => number,
        }
    }

    /// Returns the integer as a `T`; `None` if the number is a float, or `T` cannot hold it.
    pub(crate) fn whole<T: TryFrom<i64>>(self) -> Option<T> {
        match self {
            Self::Whole(whole) => T::try_from(whole).ok(),
            Self::Number(_) => None,
        }
    }
}

impl fmt::Display for Scalar {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Whole(whole) => write!(f, "{whole}"),
            // A whole one keeps its point: it is no integer.
            Self::Number(number) => write!(f, "{number:?}"),
        }
    }
}

/// A word as the value of an expression: a word of a [`Choice`](crate::ParamType::Choice) param, or
/// the word for the kind of a resource that the host's [provider](crate#terms) describes, such as
/// `spot`. Two words are equal if their fields `word` are equal.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Word {
    /// The word itself, such as `spot`.
    pub word: Name,
    /// All words of the [`Choice`](crate::ParamType::Choice) param, or for the kinds of the
    /// provider's resource, that the value comes from, in the order of their numbers; `None` if the
    /// word is written in the expression.
    pub of: Option<Arc<[Name]>>,
}

impl PartialEq for Word {
    fn eq(&self, other: &Self) -> bool {
        self.word == other.word
    }
}

/// Value of an expression ([`Expr`](crate::Expr)) in a document.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    /// An integer or a float.
    Scalar(Scalar),
    /// A boolean.
    Bool(bool),
    /// A word of a [`Choice`](crate::ParamType::Choice) param, or the word for the kind of a
    /// resource that the host's [provider](crate#terms) describes.
    Word(Word),
    /// Several numbers: a size, which is width, height and, for a 3D texture, depth in texels, or a
    /// vector with its components x, y, z, w.
    List(Vec<Scalar>),
    /// The format of a texture.
    Format(wgt::TextureFormat),
}

impl Value {
    /// Creates an integer value.
    pub(crate) fn whole(number: impl Into<i64>) -> Self {
        Self::Scalar(Scalar::Whole(number.into()))
    }

    /// Creates a word that is written in an expression.
    pub(crate) fn word(word: &Name) -> Self {
        Self::Word(Word {
            word: word.clone(),
            of: None,
        })
    }

    /// Creates the word of a provided kind, with the words of all its kinds as its `Choice`.
    pub(crate) fn kind(kind: ProvidedKind) -> Self {
        // A provider's words are names: others cannot be written.
        let name = |word: &&str| Name::new(word).ok();
        let words: Option<Arc<[Name]>> = kind.words.iter().map(name).collect();
        match Name::new(kind.word()) {
            Ok(word) => Self::Word(Word { word, of: words }),
            Err(_) => Self::whole(kind.number),
        }
    }

    /// Creates an integer from a count; a count above `i64::MAX` becomes `i64::MAX`.
    pub(crate) fn count(count: u64) -> Self {
        Self::whole(i64::try_from(count).unwrap_or(i64::MAX))
    }

    /// Returns the value's numbers; empty for values other than numbers and lists.
    pub(crate) fn scalars(&self) -> &[Scalar] {
        match self {
            Self::Scalar(scalar) => std::slice::from_ref(scalar),
            Self::List(list) => list,
            _ => &[],
        }
    }

    /// Returns the type in words, for messages.
    pub(crate) fn describe(&self) -> &'static str {
        match self {
            Self::Scalar(Scalar::Whole(_)) => "a whole number",
            Self::Scalar(Scalar::Number(_)) => "a number",
            Self::Bool(_) => "true or false",
            Self::Word(_) => "a word",
            Self::List(_) => "several numbers",
            Self::Format(_) => "a format",
        }
    }
}

impl fmt::Display for Value {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Scalar(scalar) => write!(f, "{scalar}"),
            Self::Bool(value) => write!(f, "{value}"),
            Self::Word(word) => write!(f, "{}", word.word),
            Self::List(list) => {
                let list: Vec<String> = list.iter().map(Scalar::to_string).collect();
                write!(f, "({})", list.join(", "))
            }
            Self::Format(format) => write!(f, "{format:?}"),
        }
    }
}

/// Returns the least common multiple of two numbers above 0; `u64::MAX` where it is larger.
pub(crate) fn least_common_multiple(a: u64, b: u64) -> u64 {
    let (mut divisor, mut rest) = (a, b);
    while rest > 0 {
        (divisor, rest) = (rest, divisor % rest);
    }
    (a / divisor).saturating_mul(b)
}
