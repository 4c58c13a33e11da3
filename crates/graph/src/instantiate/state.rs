//! States of materials whose sizes, and of values whose results, are found on demand.

use super::scopes::{ScopeId, Scopes, Symbol};
use crate::diagnostics::{ErrorGuaranteed, Reported};
use crate::document::{Document, Material};
use crate::language::{Expr, Leaf, Name, Value};
use crate::resource::ResourceId;
use crate::source::Located;
use std::sync::Arc;

/// State of finding a resource's size.
#[derive(Clone, Debug)]
pub(super) enum State {
    Known,
    /// The size has not been asked for yet.
    Declared(Declared),
    /// It is being found: if it is asked for now, it is made of itself.
    Resolving,
    Invalid(ErrorGuaranteed),
}

/// A material of an instance of a document, whose size is not known yet.
#[derive(Clone, Debug)]
pub(super) struct Declared {
    pub scope: ScopeId,
    pub document: Arc<Document>,
    /// Index of the material in the document's `materials`.
    pub number: usize,
}

impl Declared {
    pub fn material(&self) -> &Material {
        &self.document.materials[self.number]
    }

    /// Returns the materials that the size depends on.
    pub fn parts(&self, scopes: &Scopes) -> Vec<ResourceId> {
        let mut parts = Vec::new();
        self.material().visit(&mut |leaf| {
            let Leaf::Material(reference) = leaf else {
                return;
            };
            let mut names = reference.segments.iter().map(|segment| &segment.name.value);
            let first = names.next();
            let Some(first) = first.and_then(|name| scopes.find(self.scope, name)) else {
                return;
            };
            let mut meanings = vec![first];
            for name in names {
                let inner = meanings.iter().flat_map(|symbol| symbol.named(name));
                meanings = inner.collect();
            }
            parts.extend(meanings.iter().filter_map(|symbol| match symbol {
                Symbol::Target(target) => Some(target.id),
                _ => None,
            }));
        });
        parts
    }
}

/// Named value of an instance of a document.
#[derive(Clone, Debug)]
pub(super) struct DeclaredValue {
    pub scope: ScopeId,
    pub document: Arc<Document>,
    /// Index of the value in the document's `values`.
    pub number: usize,
    pub state: ValueState,
}

/// State of evaluating a named value.
#[derive(Clone, Debug)]
pub(super) enum ValueState {
    Declared,
    /// It is being found: if it is asked for now, it is made of itself.
    Resolving,
    Known(Reported<Value>),
}

impl DeclaredValue {
    pub fn name(&self) -> &Located<Name> {
        &self.document.values[self.number].0
    }

    pub fn expr(&self) -> &Expr {
        &self.document.values[self.number].1
    }
}
