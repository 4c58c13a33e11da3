//! Modules that stand in for others in a document's shaders.

use super::scopes::{Instance, ScopeId};
use super::symbols::{At, SymbolTable};
use crate::document::{Document, ImportEntry};
use crate::expressions::Environment;
use crate::language::Leaf;

/// Modules that have not taken effect, each with the scope of its document: its condition may need
/// a value of an include that is not walked yet.
#[derive(Default)]
pub(super) struct WaitingModules<'a>(Vec<(ScopeId, &'a ImportEntry)>);

impl<'a> WaitingModules<'a> {
    /// Adds the modules of a document, but those for which the provider lacks the resource.
    pub fn add(&mut self, document: &'a Document, scope: ScopeId, at: &At<'_, '_>) {
        let is_there = |entry: &&ImportEntry| entry.items_of.is_none_or(|it| at.is_provided(it));
        let entries = document.imports.iter().filter(is_there);
        self.0.extend(entries.map(|entry| (scope, entry)));
    }

    /// Takes out the modules whose conditions have their values; of the document whose `end` it is
    /// all that are left.
    pub fn ready(
        &mut self,
        end: Option<ScopeId>,
        symbols: &SymbolTable<'_>,
    ) -> Vec<(ScopeId, &'a ImportEntry)> {
        let is_ready = |(scope, entry): &mut (ScopeId, &ImportEntry)| {
            end == Some(*scope) || !waits(entry, *scope, symbols)
        };
        self.0.extract_if(.., is_ready).collect()
    }
}

/// True if the condition of a module needs a value that an include of the document gives and has
/// not given yet.
fn waits(entry: &ImportEntry, scope: ScopeId, symbols: &SymbolTable<'_>) -> bool {
    let mut waits = false;
    let mut check = |scope: ScopeId, leaf: Leaf<'_>| {
        let Instance {
            document, params, ..
        } = symbols.scopes.document(scope);
        let name = leaf.named().filter(|name| params.bound(name).is_none());
        let gives = |name: &str| {
            let mut includes = document.includes();
            includes.any(|(_, _, inner)| inner.gives_values.contains(name))
        };
        waits |= name.is_some_and(gives);
    };
    if let Some(condition) = &entry.condition {
        symbols.visit(scope, condition, &mut check);
    }
    waits
}
