//! The pass kinds that documents may use: an open set.

use super::{
    clear::Clear,
    compute::Compute,
    copy::Copy,
    fullscreen::Fullscreen,
    kind::{OF_PASS, PassKind},
    raster::Raster,
};
use crate::{diagnostics::diagnostic::Diagnostic, source::span::Span};
use serde::de::DeserializeOwned;
use skiagraph_located_ron::reader::{Field, from_some_fields};
use std::{fmt, sync::Arc};

/// How an entry of a kind is read.
type Parse = fn(&[Field], &Span) -> Result<Arc<dyn PassKind>, Diagnostic>;

pub(crate) struct Kind {
    pub name: &'static str,
    pub parse: Parse,
    /// Schema of its fields, where one was given.
    #[cfg(feature = "schema")]
    pub schema: Option<Described>,
}

/// Function that makes the schema of a kind's fields.
#[cfg(feature = "schema")]
type Described = fn(&mut schemars::SchemaGenerator) -> schemars::Schema;

/// The pass kinds that documents may use.
#[derive(Default)]
pub struct Registry {
    kinds: Vec<Kind>,
}

impl Registry {
    /// `Raster`, `Fullscreen`, `Compute`, `Copy` and `Clear`.
    pub fn standard() -> Self {
        let mut registry = Self::default();
        macro_rules! register {
            ($($kind:ident)*) => {$(
                registry.register::<$kind>(stringify!($kind));
                #[cfg(feature = "schema")]
                registry.describe::<$kind>(stringify!($kind));
            )*};
        }
        register!(Raster Fullscreen Compute Copy Clear);
        registry
    }

    /// Adds a kind under the tag that documents write; a kind of that tag that is already there is
    /// replaced. The language's own words (`Include`, `Group`, `Change`, `Remove`) stay what they
    /// are.
    pub fn register<K: PassKind + DeserializeOwned + 'static>(&mut self, tag: &'static str) {
        self.kinds.retain(|kind| kind.name != tag);
        let parse: Parse =
            |fields, whole| Ok(Arc::new(from_some_fields::<K>(fields, whole, &OF_PASS)?));
        self.kinds.push(Kind {
            name: tag,
            parse,
            #[cfg(feature = "schema")]
            schema: None,
        });
    }

    /// Says for [`schema`](crate::schema) what the fields of a registered kind may be; those of
    /// others are anything there.
    #[cfg(feature = "schema")]
    pub fn describe<K: schemars::JsonSchema>(&mut self, tag: &str) {
        if let Some(kind) = self.kinds.iter_mut().find(|kind| kind.name == tag) {
            kind.schema = Some(K::json_schema);
        }
    }

    #[cfg(feature = "schema")]
    pub(crate) fn all(&self) -> &[Kind] {
        &self.kinds
    }

    pub(crate) fn get(&self, tag: &str) -> Option<&Kind> {
        self.kinds.iter().find(|kind| kind.name == tag)
    }

    pub(crate) fn kinds(&self) -> impl Iterator<Item = &'static str> {
        self.kinds.iter().map(|kind| kind.name)
    }
}

impl fmt::Debug for Registry {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_list().entries(self.kinds()).finish()
    }
}
