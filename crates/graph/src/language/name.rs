//! Names of materials, params, passes and other declarations of a document.

use std::{fmt, ops::Deref, sync::Arc};

/// Most characters of a name.
const LONGEST: usize = 64;

/// Words that a name cannot be, because they have a meaning behind a dot: no material, group or
/// include may be called so.
pub(crate) const RESERVED: [&str; 13] = [
    "size", "width", "height", "layers", "mips", "samples", "count", "format", "kind", "index",
    "previous", "mip", "viewport",
];

/// A name of a material, param, pass or other declaration in a document: `[a-z][a-z0-9_]*`, at most
/// 64 characters, without `__`. Cheap to clone.
#[derive(Clone, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Name(Arc<str>);

/// Reason why a text is not a valid [`Name`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub(crate) enum NameFault {
    #[error("it is empty")]
    Empty,
    #[error("it has more than {LONGEST} characters")]
    TooLong,
    #[error("a name begins with a small letter")]
    Start,
    #[error("`{0}` cannot stand in a name: small letters, digits and `_` can")]
    Sign(char),
    #[error("WGSL reserves `__`")]
    DoubleUnderscore,
}

impl Name {
    pub(crate) fn new(text: &str) -> Result<Self, NameFault> {
        let is_part = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_';
        let first = text.chars().next().ok_or(NameFault::Empty)?;
        let is_odd = |sign: &char| !is_part(*sign) && !sign.is_ascii_uppercase();
        if let Some(sign) = text.chars().find(is_odd) {
            return Err(NameFault::Sign(sign));
        }
        if !first.is_ascii_lowercase() {
            return Err(NameFault::Start);
        }
        if let Some(sign) = text.chars().find(|&c| !is_part(c)) {
            return Err(NameFault::Sign(sign));
        }
        if text.len() > LONGEST {
            return Err(NameFault::TooLong);
        }
        if text.contains("__") {
            return Err(NameFault::DoubleUnderscore);
        }
        Ok(Self(text.into()))
    }

    /// Returns the name as text.
    pub fn as_str(&self) -> &str {
        &self.0
    }
}

impl Deref for Name {
    type Target = str;
    fn deref(&self) -> &str {
        &self.0
    }
}

impl std::borrow::Borrow<str> for Name {
    fn borrow(&self) -> &str {
        &self.0
    }
}

impl fmt::Display for Name {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl fmt::Debug for Name {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Debug::fmt(&self.0, f)
    }
}

/// Returns the WGSL identifier under which shaders find the resource or param with the [full
/// name](crate#terms) `name`: `sample[3].rays` becomes `sample_3_rays`.
pub fn wgsl_identifier(name: &str) -> String {
    name.replace(['.', '@', '['], "_").replace(']', "")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_grammar_of_names() {
        assert_eq!(Name::new("shadow_map2").unwrap().as_str(), "shadow_map2");
        for (text, fault) in [
            ("", NameFault::Empty),
            ("Map", NameFault::Start),
            ("2d", NameFault::Start),
            ("_a", NameFault::Start),
            ("a-b", NameFault::Sign('-')),
            ("aB", NameFault::Sign('B')),
            ("a.b", NameFault::Sign('.')),
            ("a__b", NameFault::DoubleUnderscore),
        ] {
            assert_eq!(Name::new(text).unwrap_err(), fault, "{text}");
        }
        assert!(Name::new(&"a".repeat(64)).is_ok());
        assert_eq!(Name::new(&"a".repeat(65)), Err(NameFault::TooLong));
    }
}
