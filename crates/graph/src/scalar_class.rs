//! Types of numbers in shaders.

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
