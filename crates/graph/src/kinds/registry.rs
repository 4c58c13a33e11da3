//! Registry of the pass kinds that documents may use. Hosts can add kinds of their own.

use super::clear::Clear;
use super::compute::Compute;
use super::copy::Copy;
use super::fullscreen::Fullscreen;
use super::kind::{OF_PASS, PassKind};
use super::raster::Raster;
use crate::{diagnostics::Diagnostic, source::Span};
use serde::de::DeserializeOwned;
use skiagraph_located_ron::{fields::from_some_fields, reader::Field};
use std::{fmt, sync::Arc};

/// Function that reads the fields of an entry as the body of a pass kind.
type Parse = fn(&[Field], &Span) -> Result<Arc<dyn PassKind>, Diagnostic>;

/// A pass kind with its tag.
pub(crate) struct Kind {
    /// Tag, as documents write it.
    pub name: &'static str,
    pub parse: Parse,
    /// Function that makes the schema of the kind's fields; `None` if none was given.
    #[cfg(feature = "schema")]
    pub schema: Option<Described>,
}

/// Function that makes the schema of a kind's fields.
#[cfg(feature = "schema")]
type Described = fn(&mut schemars::SchemaGenerator) -> schemars::Schema;

/// The pass kinds that documents may use, each with its tag: the word before the fields of a pass,
/// `Raster` in `Raster(name: …)`. The default has no kinds; [`standard`](Self::standard) has the
/// usual ones.
#[derive(Default)]
pub struct Registry {
    kinds: Vec<Kind>,
    stand_ins: Vec<StandIn>,
}

/// A module that all shaders import in the place of another one while the provider has items of a
/// resource.
pub(crate) struct StandIn {
    pub module: &'static str,
    pub is: &'static str,
    pub items_of: &'static str,
}

impl Registry {
    /// Creates a registry with this crate's kinds `Raster`, `Fullscreen`, `Compute`, `Copy` and
    /// `Clear`, under these tags.
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

    /// Adds the pass kind `K`, which documents write as `tag(…)`. Replaces a kind that already has
    /// this tag. A tag of the language's own entries (`Include`, `Group`, `Change`, `Remove`) has
    /// no effect.
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

    /// Adds the JSON schema of the fields of the registered kind `tag` to the result of
    /// [`schema`](crate::schema()). For a kind without it, the result allows any fields. A `tag`
    /// that is not registered is ignored.
    #[cfg(feature = "schema")]
    pub fn describe<K: schemars::JsonSchema>(&mut self, tag: &str) {
        if let Some(kind) = self.kinds.iter_mut().find(|kind| kind.name == tag) {
            kind.schema = Some(K::json_schema);
        }
    }

    /// Has the shaders of every document import the module `is` in the place of `module` where the
    /// host's [provider](crate#terms) has items of the resource `items_of`: as if each loaded
    /// document began its `imports` with `(of: module, is: is, if: "items_of.count > 0")`.
    /// Documents whose shaders do not import `module`, providers that do not know the resource and
    /// sources that lack one of the modules are left as they are.
    pub fn stand_in(&mut self, module: &'static str, is: &'static str, items_of: &'static str) {
        self.stand_ins.push(StandIn {
            module,
            is,
            items_of,
        });
    }

    pub(crate) fn stand_ins(&self) -> &[StandIn] {
        &self.stand_ins
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
