//! Params: the typed settings that a document takes from its host or from the document that
//! includes it.

use crate::diagnostics::suggest::{likeness, suggestion};
use crate::language::{Expr, Name, Scalar, Value, Word};
use crate::source::Located;
use serde::Serialize;
use std::{collections::BTreeMap, fmt, sync::Arc};

/// Reason why a [`Param`] of a graph cannot be set.
#[derive(Clone, Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ParamError {
    /// The graph has no param of this name.
    #[error("`{graph}` has no param `{name}`{hint}")]
    Unknown {
        /// Path of the graph's document.
        graph: String,
        /// Name that was asked for.
        name: String,
        /// End of the message, with the punctuation before it: a suggestion or list of the graph's
        /// params, or a note that the graph has none.
        hint: String,
    },
    /// The graph has the param, but the value has the wrong type, is out of range or is not an
    /// allowed word.
    #[error("param `{name}` of `{graph}`: {why}")]
    Value {
        /// Path of the graph's document.
        graph: String,
        /// Name of the param.
        name: String,
        /// Reason why the value does not fit the param.
        why: ParamFault,
    },
}

/// Returns the param called `name` of `params`; `graph` is the path of their graph, for the error.
pub(crate) fn find<'p>(
    params: &'p [Param],
    name: &str,
    graph: &str,
) -> Result<&'p Param, ParamError> {
    let param = params.iter().find(|param| param.name.value == name);
    param.ok_or_else(|| {
        let hint = suggestion(name, params.iter().map(|param| param.name.as_str()));
        ParamError::Unknown {
            graph: graph.to_owned(),
            name: name.to_owned(),
            hint: hint.map_or(", it has none".to_owned(), |hint| format!(": {hint}")),
        }
    })
}

/// Type of a [`Param`] and of its values.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ParamType {
    /// 32-bit float.
    F32,
    /// 32-bit signed integer.
    I32,
    /// 32-bit unsigned integer.
    U32,
    /// Boolean; a `u32` in WGSL, 0 or 1.
    Bool,
    /// Two 32-bit floats.
    Vec2,
    /// Three 32-bit floats.
    Vec3,
    /// Four 32-bit floats.
    Vec4,
    /// One of these words; in WGSL a `u32`, the index of the word in this list, counted from 0.
    Choice(Arc<[Name]>),
}

impl ParamType {
    /// Number of components of a vector; `None` of another type.
    fn components(&self) -> Option<usize> {
        match self {
            Self::Vec2 => Some(2),
            Self::Vec3 => Some(3),
            Self::Vec4 => Some(4),
            _ => None,
        }
    }

    /// Returns `number` as a value of this type; a vector has it in each component. `None` for
    /// `Bool` and `Choice`.
    pub(crate) fn with_number(&self, number: f64) -> Option<ParamValue> {
        Some(match self {
            Self::F32 => ParamValue::F32(number as f32),
            Self::I32 => ParamValue::I32(number as i32),
            Self::U32 => ParamValue::U32(number as u32),
            _ => ParamValue::Vec(vec![number as f32; self.components()?]),
        })
    }
}

impl fmt::Display for ParamType {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Choice(words) => {
                let words: Vec<&str> = words.iter().map(Name::as_str).collect();
                f.write_str(&words.join("|"))
            }
            other => write!(f, "{}", format!("{other:?}").to_lowercase()),
        }
    }
}

/// Value of a [`Param`]. Each variant belongs to the [`ParamType`] of the same name; `Vec` belongs
/// to all vectors.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum ParamValue {
    /// 32-bit float.
    F32(f32),
    /// 32-bit signed integer.
    I32(i32),
    /// 32-bit unsigned integer.
    U32(u32),
    /// Boolean.
    Bool(bool),
    /// Two to four 32-bit floats, for `Vec2`, `Vec3` and `Vec4`: x, y, z, w.
    Vec(Vec<f32>),
    /// A word of the param's [`ParamType::Choice`].
    Choice(String),
}

impl fmt::Display for ParamValue {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::F32(value) => write!(f, "{value}"),
            Self::I32(value) => write!(f, "{value}"),
            Self::U32(value) => write!(f, "{value}"),
            Self::Bool(value) => write!(f, "{value}"),
            Self::Vec(values) => {
                let parts: Vec<String> = values.iter().map(f32::to_string).collect();
                write!(f, "{}", parts.join(","))
            }
            Self::Choice(word) => f.write_str(word),
        }
    }
}

/// A typed setting of a graph: a number, vector, bool or word that shaders and expressions read and
/// the host sets in [`Request::params`](crate::Request::params). The document declares the param,
/// or exposes it from a document that it includes.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Param {
    /// Name, as in `params.NAME` of a shader and `--set NAME=…` on the command line, with its place
    /// in the document. A param that a named include exposes has the [include](crate#terms)'s name
    /// before it: `left.radius`, `params.left_radius` in a shader.
    pub name: Located<String>,
    /// Type of the param's values; for a `Choice` with its words.
    pub ty: ParamType,
    /// Expression for the value that the param has unless it is set; `None` if the document gives
    /// none. A param of an included document must then be set by the [include](crate#terms), or be
    /// a param of the including document, too. A param of the loaded document that has no default
    /// and is not set has its `min`, or 1 (at most its `max`) without one; false; or its first
    /// allowed word.
    pub default: Option<Expr>,
    /// Least allowed value of the param if it is a number, or of each of its components if it is a
    /// vector; `None` for no lower bound.
    pub min: Option<f64>,
    /// Greatest allowed value of the param if it is a number, or of each of its components if it is
    /// a vector; `None` for no upper bound.
    pub max: Option<f64>,
    /// Description of the param's effect, as its document gives it; may be empty.
    pub description: String,
    /// Words of a [`ParamType::Choice`] that cannot be set because the section `narrow` of a
    /// document excludes them: each word with the reason that the document gives. Empty if no word
    /// is excluded, and for other types.
    pub refused: BTreeMap<String, String>,
    /// Values that the search of `skiagraph compare --tune` for good settings tries, at least two
    /// and all different; empty if the search leaves the param alone.
    pub tune: Vec<ParamValue>,
    /// True if the param decides how soft shadows look, by the field `look` of its document: the
    /// search tries [`tune`](Self::tune) only under lights with an extent.
    pub is_look: bool,
}

/// Reason why a value does not fit a [`Param`].
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ParamFault {
    /// The value has another type; holds the expected type in words, such as `f32` or `front|back`.
    #[error("the value must be of type {0}")]
    Type(String),
    /// The value has the right type, but lies out of range or is not an allowed word; holds the
    /// message.
    #[error("{0}")]
    Value(String),
}

impl Param {
    /// Iterates over the words of a [`ParamType::Choice`] that may be set, in the order of the
    /// type's list, without those in [`refused`](Self::refused). Empty for every other type.
    pub fn words(&self) -> impl Iterator<Item = &Name> {
        let words = match &self.ty {
            ParamType::Choice(words) => &words[..],
            _ => &[],
        };
        let is_left = |word: &&Name| !self.refused.contains_key(word.as_str());
        words.iter().filter(is_left)
    }

    /// Keeps only the words `kept` of a `Choice`, and refuses its others with the reason `because`.
    /// The indices of words do not change.
    ///
    /// # Errors
    /// The first word in `kept` that is not a word of the param, or `None` if the param is not a
    /// `Choice`.
    pub(crate) fn narrow(
        &mut self,
        kept: &[Located<Name>],
        because: &str,
    ) -> Result<(), Option<Located<Name>>> {
        if !matches!(self.ty, ParamType::Choice(_)) {
            return Err(None);
        }
        let is_unknown = |word: &&Located<Name>| self.words().all(|other| *other != word.value);
        if let Some(word) = kept.iter().find(is_unknown) {
            return Err(Some(word.clone()));
        }
        let is_gone = |word: &&Name| kept.iter().all(|kept| kept.value != **word);
        let gone = self.words().filter(is_gone);
        let gone: Vec<String> = gone.map(Name::to_string).collect();
        self.tune.retain(|value| match value {
            ParamValue::Choice(word) => !gone.contains(word),
            _ => true,
        });
        if self.tune.len() < 2 {
            self.tune.clear();
        }
        self.refused
            .extend(gone.into_iter().map(|word| (word, because.to_owned())));
        Ok(())
    }

    /// Converts the value of an expression to a value of this param, and checks its range.
    ///
    /// # Errors
    /// The expected type or range.
    pub(crate) fn convert(&self, value: &Value) -> Result<ParamValue, ParamFault> {
        let wrong = || ParamFault::Type(self.ty.to_string());
        let converted = match (&self.ty, value) {
            (ParamType::F32, Value::Scalar(scalar)) => ParamValue::F32(scalar.number() as f32),
            (ParamType::I32, Value::Scalar(scalar)) => {
                ParamValue::I32(scalar.whole().ok_or_else(wrong)?)
            }
            (ParamType::U32, Value::Scalar(scalar)) => {
                ParamValue::U32(scalar.whole().ok_or_else(wrong)?)
            }
            (ParamType::Bool, Value::Bool(value)) => ParamValue::Bool(*value),
            (ty, Value::List(list)) if ty.components() == Some(list.len()) => {
                let list = list.iter().map(|scalar| scalar.number() as f32);
                ParamValue::Vec(list.collect())
            }
            (ParamType::Choice(_), Value::Word(word)) => ParamValue::Choice(word.word.to_string()),
            _ => return Err(wrong()),
        };
        self.check(&converted).map(|()| converted)
    }

    /// Returns `value`, a value of this param, as a value of an expression.
    pub(crate) fn value(&self, value: &ParamValue) -> Value {
        // The decimal number that it was written as: 0.51 is no f32, and yet `n >= 0.51` holds of
        // it.
        let number = |number: &f32| {
            let written = number.to_string().parse();
            Scalar::Number(written.unwrap_or(f64::from(*number)))
        };
        match value {
            ParamValue::F32(value) => Value::Scalar(number(value)),
            ParamValue::I32(value) => Value::whole(*value),
            ParamValue::U32(value) => Value::whole(*value),
            ParamValue::Bool(value) => Value::Bool(*value),
            ParamValue::Vec(values) => Value::List(values.iter().map(number).collect()),
            ParamValue::Choice(word) => {
                let words = match &self.ty {
                    ParamType::Choice(words) => Some(Arc::clone(words)),
                    _ => None,
                };
                let choices = words.iter().flat_map(|words| words.iter());
                // A checked value is one of the words. Any other equals none of them.
                match choices.clone().find(|choice| ***choice == **word).cloned() {
                    Some(word) => Value::Word(Word { word, of: words }),
                    None => Value::Bool(false),
                }
            }
        }
    }

    /// Returns a valid value to use where none is given: for a number `min`, else 1; for a bool
    /// false; for a choice its first word.
    pub(crate) fn stand_in(&self) -> ParamValue {
        let most = self.max.unwrap_or(f64::INFINITY);
        let number = self.min.unwrap_or(1.0).min(most);
        let number = self.ty.with_number(number);
        number.unwrap_or_else(|| match &self.ty {
            ParamType::Choice(_) => {
                ParamValue::Choice(self.words().next().map(Name::to_string).unwrap_or_default())
            }
            _ => ParamValue::Bool(false),
        })
    }

    /// True if every value of `other` is a value of this param.
    pub(crate) fn holds_all_of(&self, other: &Param) -> bool {
        let above = |least: f64| other.min.is_some_and(|other| least <= other);
        let below = |most: f64| other.max.is_some_and(|other| most >= other);
        let within = self.min.is_none_or(above) && self.max.is_none_or(below);
        match (&self.ty, &other.ty) {
            (ParamType::Choice(_), ParamType::Choice(_)) => other
                .words()
                .all(|word| self.words().any(|own| own == word)),
            (a, b) => a == b && within,
        }
    }

    /// Reads a value from text, as the command line writes it: `1024`, `0.5`, `true` or `1`, the
    /// word `front`, the vector `1,2,3`.
    ///
    /// # Errors
    /// If the text is not a value of the param's type, or the value is out of range, not finite or
    /// not an allowed word.
    pub fn parse(&self, text: &str) -> Result<ParamValue, ParamFault> {
        let wrong = || ParamFault::Type(self.ty.to_string());
        let scalar = |text: &str| {
            let text = text.trim();
            let whole = text.parse().map(Scalar::Whole).ok();
            // 1e3 and 4.0 are whole numbers, too.
            let number = || {
                let number: f64 = text.parse().ok()?;
                let is_whole = number.fract() == 0.0 && number.abs() < 9e15;
                Some(if is_whole && self.ty != ParamType::F32 {
                    Scalar::Whole(number as i64)
                } else {
                    Scalar::Number(number)
                })
            };
            whole.or_else(number).ok_or_else(wrong)
        };
        let value = match self.ty {
            ParamType::Choice(_) => return self.checked(ParamValue::Choice(text.to_owned())),
            ParamType::Bool => match text {
                "true" | "1" => Value::Bool(true),
                "false" | "0" => Value::Bool(false),
                _ => {
                    let why = "the value must be true or false";
                    return Err(ParamFault::Value(why.to_owned()));
                }
            },
            ParamType::Vec2 | ParamType::Vec3 | ParamType::Vec4 => {
                Value::List(text.split(',').map(scalar).collect::<Result<_, _>>()?)
            }
            _ => Value::Scalar(scalar(text)?),
        };
        self.convert(&value)
    }

    fn checked(&self, value: ParamValue) -> Result<ParamValue, ParamFault> {
        self.check(&value).map(|()| value)
    }

    /// Checks that a value has the param's type and lies in its range, the ends included, or is an
    /// allowed word.
    ///
    /// # Errors
    /// If the value has another type, or is out of range, not finite or not an allowed word.
    pub fn check(&self, value: &ParamValue) -> Result<(), ParamFault> {
        let numbers: Vec<f64> = match (&self.ty, value) {
            (ParamType::F32, ParamValue::F32(v)) => vec![f64::from(*v)],
            (ParamType::I32, ParamValue::I32(v)) => vec![f64::from(*v)],
            (ParamType::U32, ParamValue::U32(v)) => vec![f64::from(*v)],
            (ParamType::Bool, ParamValue::Bool(_)) => Vec::new(),
            (ty, ParamValue::Vec(v)) if ty.components() == Some(v.len()) => {
                v.iter().map(|&v| f64::from(v)).collect()
            }
            (ParamType::Choice(_), ParamValue::Choice(word)) => {
                let words: Vec<&str> = self.words().map(Name::as_str).collect();
                let choices = words.join(", ");
                return match (words.contains(&word.as_str()), self.refused.get(word)) {
                    (true, _) => Ok(()),
                    (_, None) => {
                        let likeness = likeness(word, &words);
                        let likeness = likeness.map_or(String::new(), |it| format!("; {it}"));
                        let why = format!("must be one of {choices}{likeness}");
                        Err(ParamFault::Value(why))
                    }
                    (_, Some(why)) => Err(ParamFault::Value(format!(
                        "`{word}` is refused: {why}; must be one of {choices}"
                    ))),
                };
            }
            _ => return Err(ParamFault::Type(self.ty.to_string())),
        };
        // Bounds as values are stored: 0.51 is no f32, and yet within 0.51 and up.
        let whole = matches!(self.ty, ParamType::I32 | ParamType::U32);
        let stored = |bound: f64| {
            if whole {
                bound
            } else {
                f64::from(bound as f32)
            }
        };
        for number in numbers {
            if !number.is_finite() {
                return Err(ParamFault::Value("the value must be finite".to_owned()));
            }
            let below = self.min.is_some_and(|min| number < stored(min));
            if below || self.max.is_some_and(|max| number > stored(max)) {
                let shown = if whole {
                    number.to_string()
                } else {
                    (number as f32).to_string()
                };
                return Err(ParamFault::Value(match (self.min, self.max) {
                    (Some(min), Some(max)) => format!("must lie in {min}..{max}, not {shown}"),
                    (Some(min), None) => format!("must be at least {min}, not {shown}"),
                    (None, max) => {
                        let max = max.unwrap_or(f64::INFINITY);
                        format!("must be at most {max}, not {shown}")
                    }
                }));
            }
        }
        Ok(())
    }

    /// Returns a value of this param as the `u32` of a shader: the index of a word, 0 or 1 of a
    /// bool, or a non-negative integer. `None` for other values.
    pub(crate) fn as_u32(&self, value: &ParamValue) -> Option<u32> {
        match (value, &self.ty) {
            (ParamValue::U32(value), _) => Some(*value),
            (ParamValue::I32(value), _) => u32::try_from(*value).ok(),
            (ParamValue::Bool(value), _) => Some(u32::from(*value)),
            (ParamValue::Choice(word), ParamType::Choice(words)) => words
                .iter()
                .position(|choice| **choice == **word)
                .and_then(|index| u32::try_from(index).ok()),
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::source::span::SourceFile;

    #[test]
    fn bounds_are_rounded_as_values_are() {
        let param = Param {
            name: Located::new("n".to_owned(), SourceFile::new("graph.ron", "").span(0..0)),
            ty: ParamType::F32,
            default: None,
            min: Some(0.51),
            max: Some(0.7),
            description: String::new(),
            refused: BTreeMap::new(),
            tune: Vec::new(),
            is_look: false,
        };
        for (text, inside) in [
            ("0.51", true),
            ("0.7", true),
            ("0.5099999", false),
            ("0.7000001", false),
        ] {
            assert_eq!(param.parse(text).is_ok(), inside, "{text}");
        }
        assert_eq!(
            param.parse("0.3").unwrap_err().to_string(),
            "must lie in 0.51..0.7, not 0.3"
        );
    }
}
