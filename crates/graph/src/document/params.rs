//! Params: the typed knobs of a document.

use super::located::Located;
use serde::{Deserialize, Deserializer, Serialize};
use std::fmt;

/// Type of a param.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize)]
pub enum ParamType {
    /// 32-bit float.
    F32,
    /// 32-bit signed integer.
    I32,
    /// 32-bit unsigned integer.
    U32,
    /// Boolean; travels to WGSL as `u32` 0 or 1.
    Bool,
    /// Two floats.
    Vec2,
    /// Three floats.
    Vec3,
    /// Four floats.
    Vec4,
    /// One of the named words; travels to WGSL as its index, `u32`.
    Choice(Vec<String>),
}

impl fmt::Display for ParamType {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Choice(words) => write!(f, "{}", words.join("|")),
            other => write!(f, "{}", format!("{other:?}").to_lowercase()),
        }
    }
}

/// Value of a param.
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
    /// Two to four floats.
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

/// A declared param.
#[derive(Clone, Debug)]
pub struct Param {
    /// Name, as in `params.NAME` of a shader and `--set NAME=…`.
    pub name: Located<String>,
    /// Type.
    pub ty: ParamType,
    /// Value where nothing else is asked for.
    pub default: ParamValue,
    /// Least value of a number (each component of a vector).
    pub min: Option<f64>,
    /// Greatest value of a number (each component of a vector).
    pub max: Option<f64>,
    /// What it does.
    pub description: String,
}

/// A param as the document writes it.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct ParamEntry {
    pub name: Located<String>,
    #[serde(rename = "type")]
    pub ty: ParamType,
    pub default: Located<Written>,
    #[serde(default)]
    pub min: Option<f64>,
    #[serde(default)]
    pub max: Option<f64>,
    #[serde(default)]
    pub description: String,
}

/// A default as the document writes it: number, bool, word or tuple of numbers.
#[derive(Clone, Debug)]
pub(crate) enum Written {
    Number(f64),
    Bool(bool),
    Word(String),
    Tuple(Vec<f64>),
}

impl<'de> Deserialize<'de> for Written {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Visitor;
        impl<'de> serde::de::Visitor<'de> for Visitor {
            type Value = Written;
            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a number, true or false, a \"word\", or a tuple of numbers")
            }
            fn visit_bool<E>(self, value: bool) -> Result<Written, E> {
                Ok(Written::Bool(value))
            }
            fn visit_i64<E>(self, value: i64) -> Result<Written, E> {
                Ok(Written::Number(value as f64))
            }
            fn visit_u64<E>(self, value: u64) -> Result<Written, E> {
                Ok(Written::Number(value as f64))
            }
            fn visit_f64<E>(self, value: f64) -> Result<Written, E> {
                Ok(Written::Number(value))
            }
            fn visit_unit<E: serde::de::Error>(self) -> Result<Written, E> {
                Err(E::custom("a word stands in quotes: \"word\""))
            }
            fn visit_str<E>(self, value: &str) -> Result<Written, E> {
                Ok(Written::Word(value.to_owned()))
            }
            fn visit_seq<A: serde::de::SeqAccess<'de>>(
                self,
                mut seq: A,
            ) -> Result<Written, A::Error> {
                let mut values = Vec::new();
                while let Some(value) = seq.next_element()? {
                    values.push(value);
                }
                Ok(Written::Tuple(values))
            }
        }
        deserializer.deserialize_any(Visitor)
    }
}

impl Param {
    /// Turns the entry into a param, or says why its default does not fit.
    pub(crate) fn from_entry(entry: ParamEntry) -> Result<Self, (Located<String>, String)> {
        let place = Located::new(entry.name.value.clone(), entry.default.span.clone());
        let mut param = Self {
            name: entry.name,
            ty: entry.ty,
            default: ParamValue::Bool(false),
            min: entry.min,
            max: entry.max,
            description: entry.description,
        };
        if let ParamType::Choice(words) = &param.ty {
            let different: std::collections::HashSet<&String> = words.iter().collect();
            let repeated = different.len() < words.len();
            if words.is_empty() || repeated {
                return Err((
                    place,
                    "a Choice has at least one word, and each only once".to_owned(),
                ));
            }
        }
        if let (Some(min), Some(max)) = (param.min, param.max)
            && min.partial_cmp(&max).is_none_or(std::cmp::Ordering::is_gt)
        {
            return Err((place, format!("no value can lie in {min}..{max}")));
        }
        match param.read(&entry.default.value) {
            Ok(value) => {
                param.default = value;
                Ok(param)
            }
            Err(why) => Err((place, why)),
        }
    }

    /// The value that a document writes, if it fits.
    pub(crate) fn read(&self, written: &Written) -> Result<ParamValue, String> {
        let value = self.value_of(written)?;
        self.check(&value).map(|()| value)
    }

    fn value_of(&self, written: &Written) -> Result<ParamValue, String> {
        let wrong = || format!("the value must be of type {}", self.ty);
        let whole = |number: f64| (number.fract() == 0.0).then_some(number).ok_or_else(wrong);
        let vector = |length: usize| match written {
            Written::Tuple(values) if values.len() == length => Ok(ParamValue::Vec(
                values.iter().map(|&value| value as f32).collect(),
            )),
            _ => Err(wrong()),
        };
        match (&self.ty, written) {
            (ParamType::F32, Written::Number(number)) => Ok(ParamValue::F32(*number as f32)),
            (ParamType::I32, Written::Number(number)) => whole(*number).and_then(|n| {
                if n >= f64::from(i32::MIN) && n <= f64::from(i32::MAX) {
                    Ok(ParamValue::I32(n as i32))
                } else {
                    Err(wrong())
                }
            }),
            (ParamType::U32, Written::Number(number)) => whole(*number).and_then(|n| {
                if (0.0..=f64::from(u32::MAX)).contains(&n) {
                    Ok(ParamValue::U32(n as u32))
                } else {
                    Err(wrong())
                }
            }),
            (ParamType::Bool, Written::Bool(value)) => Ok(ParamValue::Bool(*value)),
            (ParamType::Vec2, _) => vector(2),
            (ParamType::Vec3, _) => vector(3),
            (ParamType::Vec4, _) => vector(4),
            (ParamType::Choice(_), Written::Word(word)) => Ok(ParamValue::Choice(word.clone())),
            _ => Err(wrong()),
        }
    }

    /// Reads a value from text as the command line writes it: `1024`, `0.5`, `true`, `front`, `1,2,3`.
    ///
    /// # Errors
    /// What was expected.
    pub fn parse(&self, text: &str) -> Result<ParamValue, String> {
        let number = |text: &str| {
            text.trim()
                .parse::<f64>()
                .map_err(|_| format!("the value must be of type {}", self.ty))
        };
        let written = match self.ty {
            ParamType::Choice(_) => Written::Word(text.to_owned()),
            ParamType::Bool => match text {
                "true" | "1" => Written::Bool(true),
                "false" | "0" => Written::Bool(false),
                _ => return Err("the value must be true or false".to_owned()),
            },
            ParamType::Vec2 | ParamType::Vec3 | ParamType::Vec4 => {
                Written::Tuple(text.split(',').map(number).collect::<Result<_, _>>()?)
            }
            _ => Written::Number(number(text)?),
        };
        self.read(&written)
    }

    /// Whether a value has the param's type and lies in its range.
    ///
    /// # Errors
    /// What was expected.
    pub fn check(&self, value: &ParamValue) -> Result<(), String> {
        let numbers: Vec<f64> = match (&self.ty, value) {
            (ParamType::F32, ParamValue::F32(v)) => vec![f64::from(*v)],
            (ParamType::I32, ParamValue::I32(v)) => vec![f64::from(*v)],
            (ParamType::U32, ParamValue::U32(v)) => vec![f64::from(*v)],
            (ParamType::Bool, ParamValue::Bool(_)) => Vec::new(),
            (ParamType::Vec2, ParamValue::Vec(v)) if v.len() == 2 => {
                v.iter().map(|&v| f64::from(v)).collect()
            }
            (ParamType::Vec3, ParamValue::Vec(v)) if v.len() == 3 => {
                v.iter().map(|&v| f64::from(v)).collect()
            }
            (ParamType::Vec4, ParamValue::Vec(v)) if v.len() == 4 => {
                v.iter().map(|&v| f64::from(v)).collect()
            }
            (ParamType::Choice(words), ParamValue::Choice(word)) => {
                return if words.contains(word) {
                    Ok(())
                } else {
                    Err(format!("must be one of {}", words.join(", ")))
                };
            }
            _ => return Err(format!("the value must be of type {}", self.ty)),
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
                return Err("the value must be finite".to_owned());
            }
            let below = self.min.is_some_and(|min| number < stored(min));
            if below || self.max.is_some_and(|max| number > stored(max)) {
                let shown = match whole {
                    true => number.to_string(),
                    false => (number as f32).to_string(),
                };
                return Err(match (self.min, self.max) {
                    (Some(min), Some(max)) => format!("must lie in {min}..{max}, not {shown}"),
                    (Some(min), None) => format!("must be at least {min}, not {shown}"),
                    (None, max) => format!(
                        "must be at most {}, not {shown}",
                        max.unwrap_or(f64::INFINITY)
                    ),
                });
            }
        }
        Ok(())
    }

    /// The index of a choice's word, the number of a bool, or the integer of a value.
    pub(crate) fn as_u32(&self, value: &ParamValue) -> Option<u32> {
        match (value, &self.ty) {
            (ParamValue::U32(value), _) => Some(*value),
            (ParamValue::I32(value), _) => u32::try_from(*value).ok(),
            (ParamValue::Bool(value), _) => Some(u32::from(*value)),
            (ParamValue::Choice(word), ParamType::Choice(words)) => words
                .iter()
                .position(|known| known == word)
                .and_then(|index| u32::try_from(index).ok()),
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::source::SourceFile;

    #[test]
    fn bounds_are_rounded_as_values_are() {
        let param = Param {
            name: Located::new("n".to_owned(), SourceFile::new("graph.ron", "").span(0..0)),
            ty: ParamType::F32,
            default: ParamValue::F32(0.51),
            min: Some(0.51),
            max: Some(0.7),
            description: String::new(),
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
            param.parse("0.3").unwrap_err(),
            "must lie in 0.51..0.7, not 0.3"
        );
    }
}
