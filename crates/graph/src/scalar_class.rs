//! Types of numbers in shaders.

use crate::language::Scalar;
use std::fmt;

/// Scalar type of the channels of a texture, as a shader sees it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ScalarClass {
    Float,
    Uint,
    Sint,
}

impl fmt::Display for ScalarClass {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Float => "f32",
            Self::Uint => "u32",
            Self::Sint => "i32",
        })
    }
}

/// Type of a number or vector in a shader, such as `vec2<f32>`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct ShaderType {
    /// Type of the number, or of each component of the vector.
    pub class: ScalarClass,
    /// Number of components; 1 for a number.
    pub width: u32,
}

impl fmt::Display for ShaderType {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.width {
            1 => write!(f, "{}", self.class),
            width => write!(f, "vec{width}<{}>", self.class),
        }
    }
}

impl ShaderType {
    /// Returns the type in words, for messages.
    pub fn words(self) -> String {
        match (self.width, self.class) {
            (1, ScalarClass::Float) => "a number (f32)".to_owned(),
            (1, ScalarClass::Sint) => "a whole number (i32)".to_owned(),
            (1, ScalarClass::Uint) => "a whole number from 0 (u32)".to_owned(),
            _ => format!("a {self}"),
        }
    }

    /// Returns the way out for a value of these numbers, none of a word, that this type does not
    /// hold. `text` is the value as the document writes it.
    pub fn way_out(self, numbers: &[Scalar], text: &str) -> String {
        let least = if self.class == ScalarClass::Uint {
            0.0
        } else {
            f64::MIN
        };
        match (numbers, self.width) {
            ([_], 1) if self.class == ScalarClass::Float => {
                "write one that 32 bits hold".to_owned()
            }
            ([number], 1) if text.parse::<f64>().is_ok() => {
                format!("write `{}`", number.number().round().max(least))
            }
            ([number], 1) if number.number() < least => {
                format!("write `\"max(floor({text}), 0)\"`")
            }
            ([_], 1) => format!("write `\"floor({text})\"`"),
            (_, 1) => "write one number".to_owned(),
            (_, width) => format!(
                "write {width}: `({})`",
                vec!["0"; width as usize].join(", ")
            ),
        }
    }

    /// Returns the type of params whose values a member of this type holds; `None` if there is
    /// none.
    pub fn param(self) -> Option<String> {
        Some(match (self.class, self.width) {
            (ScalarClass::Float, 1) => "F32".to_owned(),
            (ScalarClass::Float, width) => format!("Vec{width}"),
            (ScalarClass::Uint, 1) => "U32".to_owned(),
            (ScalarClass::Sint, 1) => "I32".to_owned(),
            _ => return None,
        })
    }
}

impl ScalarClass {
    pub fn from_kind(kind: naga::ScalarKind) -> Option<Self> {
        match kind {
            naga::ScalarKind::Float => Some(Self::Float),
            naga::ScalarKind::Uint => Some(Self::Uint),
            naga::ScalarKind::Sint => Some(Self::Sint),
            _ => None,
        }
    }
}
