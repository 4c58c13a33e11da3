//! Types of numbers in shaders.

use crate::language::Scalar;
use std::fmt;

/// Type of a 32-bit scalar in an item of a buffer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ItemScalar {
    /// `f32`.
    F32,
    /// `i32`.
    I32,
    /// `u32`.
    U32,
}

impl ItemScalar {
    /// Returns the name of the type in WGSL.
    pub(crate) fn as_str(self) -> &'static str {
        match self {
            Self::F32 => "f32",
            Self::I32 => "i32",
            Self::U32 => "u32",
        }
    }

    /// Returns the type of scalars of a kind, whatever their width; `None` for booleans and
    /// abstract numbers.
    pub(crate) fn from_kind(kind: naga::ScalarKind) -> Option<Self> {
        match kind {
            naga::ScalarKind::Float => Some(Self::F32),
            naga::ScalarKind::Uint => Some(Self::U32),
            naga::ScalarKind::Sint => Some(Self::I32),
            _ => None,
        }
    }

    /// Returns the bits of `number` as this type; `None` if the type cannot hold it.
    pub(crate) fn bits(self, number: f64) -> Option<u32> {
        let whole = number.fract() == 0.0;
        match self {
            Self::F32 => Some((number as f32).to_bits()),
            Self::U32 => {
                (whole && (0.0..=f64::from(u32::MAX)).contains(&number)).then_some(number as u32)
            }
            Self::I32 => {
                let fits = (f64::from(i32::MIN)..=f64::from(i32::MAX)).contains(&number);
                (whole && fits).then_some((number as i32).cast_unsigned())
            }
        }
    }
}

/// Type of a number or vector in a shader, such as `vec2<f32>`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct ShaderType {
    /// Type of the number, or of each component of the vector.
    pub class: ItemScalar,
    /// Number of components; 1 for a number.
    pub width: u32,
}

impl fmt::Display for ShaderType {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.width {
            1 => f.write_str(self.class.as_str()),
            width => write!(f, "vec{width}<{}>", self.class.as_str()),
        }
    }
}

impl ShaderType {
    /// Returns the type in words, for messages.
    pub fn words(self) -> String {
        match (self.width, self.class) {
            (1, ItemScalar::F32) => "a number (f32)".to_owned(),
            (1, ItemScalar::I32) => "a whole number (i32)".to_owned(),
            (1, ItemScalar::U32) => "a whole number from 0 (u32)".to_owned(),
            _ => format!("a {self}"),
        }
    }

    /// Returns the way out for a value of these numbers, none of a word, that this type does not
    /// hold. `text` is the value as the document writes it.
    pub fn way_out(self, numbers: &[Scalar], text: &str) -> String {
        let least = if self.class == ItemScalar::U32 {
            0.0
        } else {
            f64::MIN
        };
        match (numbers, self.width) {
            ([_], 1) if self.class == ItemScalar::F32 => "write one that 32 bits hold".to_owned(),
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
            (ItemScalar::F32, 1) => "F32".to_owned(),
            (ItemScalar::F32, width) => format!("Vec{width}"),
            (ItemScalar::U32, 1) => "U32".to_owned(),
            (ItemScalar::I32, 1) => "I32".to_owned(),
            _ => return None,
        })
    }
}
