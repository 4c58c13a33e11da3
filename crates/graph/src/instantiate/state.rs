//! Materials on their way to a size, and values on theirs to a number.

use super::scopes::ScopeId;
use crate::{
    diagnostics::reports::{ErrorGuaranteed, Reported},
    document::{materials::Material, typed::Document},
    language::{name::Name, syntax::Expr, value::Value},
    source::span::Located,
};
use std::sync::Arc;

/// State of a resource's size.
#[derive(Clone, Debug)]
pub(super) enum State {
    Known,
    /// Its size has not been asked for yet.
    Declared(Declared),
    /// It is being found: if it is asked for now, it is made of itself.
    Resolving,
    Invalid(ErrorGuaranteed),
}

/// A material of an instance of a document.
#[derive(Clone, Debug)]
pub(super) struct Declared {
    pub scope: ScopeId,
    pub document: Arc<Document>,
    /// Its number among the document's materials.
    pub number: usize,
}

impl Declared {
    pub fn material(&self) -> &Material {
        &self.document.materials[self.number]
    }
}

/// A value of an instance of a document.
#[derive(Clone, Debug)]
pub(super) struct DeclaredValue {
    pub scope: ScopeId,
    pub document: Arc<Document>,
    /// Its number among the document's values.
    pub number: usize,
    pub state: ValueState,
}

/// How far a value is known.
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
