//! Materials on their way to a size.

use super::scopes::ScopeId;
use crate::{
    diagnostics::reports::ErrorGuaranteed,
    document::{materials::Material, typed::Document},
    source::span::Span,
};
use std::sync::Arc;

/// Whether the size of a resource is known.
#[derive(Clone, Debug)]
pub(super) enum State {
    Known,
    /// Nobody has asked for it yet.
    Declared(Declared),
    /// It is being found: who asks for it now is what it is made of.
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
    pub span: Span,
}

impl Declared {
    pub fn material(&self) -> &Material {
        &self.document.materials[self.number]
    }
}
