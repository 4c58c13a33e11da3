//! Values that several entries share: a literal or a param, comparison functions, named pairs.

use super::{
    MOST_ENTRIES,
    located::{self, Located},
};
use crate::{
    diagnostics::{Code, Diagnostic},
    resolve::previous,
};
use serde::{
    Deserialize, Deserializer,
    de::{DeserializeOwned, MapAccess, Visitor},
};
use std::{collections::HashSet, fmt, marker::PhantomData};

/// A literal, or `Param("name")`.
#[derive(Clone, Debug)]
pub enum Value<T> {
    /// Written out.
    Literal(T),
    /// The value of a param.
    Param(Located<String>),
}

impl<'de, T: DeserializeOwned> Deserialize<'de> for Value<T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        #[derive(Deserialize)]
        enum Reference {
            Param(Located<String>),
        }
        match located::literal::<T, D>(deserializer)? {
            Ok(value) => Ok(Self::Literal(value)),
            Err(text) if text.starts_with("Param") => {
                let Reference::Param(name) = located::word::<Reference, D::Error>(text)?;
                Ok(Self::Param(name))
            }
            Err(text) => located::word(text).map(Self::Literal),
        }
    }
}

/// A comparison, true where the new value stands in this relation to the stored one.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[expect(missing_docs, reason = "the names are the relations")]
pub enum Compare {
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

impl From<Compare> for wgpu::CompareFunction {
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

/// What a pass reads: `"name"`, or `Previous("name")` for what it held at the end of the frame before.
#[derive(Clone, Debug)]
pub(crate) struct Reference(pub Located<String>);

impl<'de> Deserialize<'de> for Reference {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        /// The name, in either spelling.
        struct Name(String);
        impl<'de> Deserialize<'de> for Name {
            fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
                #[derive(Deserialize)]
                #[serde(rename = "name")]
                enum Words {
                    Previous(String),
                }
                Ok(Self(match located::literal(deserializer)? {
                    Ok(name) => name,
                    Err(word) => match located::word::<Words, D::Error>(word)? {
                        Words::Previous(name) => previous(&name),
                    },
                }))
            }
        }
        let Located { value, span } = Located::<Name>::deserialize(deserializer)?;
        Ok(Self(Located::new(value.0, span)))
    }
}

/// A RON map of names to values in file order, duplicates kept (ron itself drops them without a word).
#[derive(Clone, Debug)]
pub struct Map<V>(pub Vec<(Located<String>, V)>);

impl<V> Default for Map<V> {
    fn default() -> Self {
        Self(Vec::new())
    }
}

impl<V> Map<V> {
    /// The entries, or the first key that is there twice or beyond the most entries.
    pub(crate) fn unique(self, what: &str) -> Result<Vec<(Located<String>, V)>, Diagnostic> {
        if let Some((key, _)) = self.0.get(MOST_ENTRIES) {
            let count = self.0.len();
            return Err(Diagnostic::error(
                Code::Size,
                format!("the map has {count} entries, {MOST_ENTRIES} is the most"),
            )
            .at(key.span.clone(), "this one is too many")
            .help("split what it is for, and `Include` its parts"));
        }
        let mut seen = HashSet::new();
        match self.0.iter().find(|(key, _)| !seen.insert(key.as_str())) {
            Some((key, _)) => Err(Diagnostic::error(
                Code::DuplicateName,
                format!("`{}` is {what} twice", **key),
            )
            .at(key.span.clone(), "the second one")),
            None => Ok(self.0),
        }
    }
}

impl<'de, V: DeserializeOwned> Deserialize<'de> for Map<V> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Entries<V>(PhantomData<V>);
        impl<'de, V: DeserializeOwned> Visitor<'de> for Entries<V> {
            type Value = Map<V>;
            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a map of names, {\"a\": …}")
            }
            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Map<V>, A::Error> {
                let mut pairs = Vec::new();
                while let Some(pair) = map.next_entry()? {
                    pairs.push(pair);
                }
                Ok(Map(pairs))
            }
        }
        deserializer.deserialize_map(Entries(PhantomData))
    }
}
