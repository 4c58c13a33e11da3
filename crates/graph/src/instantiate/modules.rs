//! Modules that stand in for others in a document's shaders.

use super::{
    build::Builder,
    scopes::{Instance, ScopeId},
};
use crate::{
    document::typed::{Document, ImportEntry},
    expressions::eval::Environment,
    language::syntax::Leaf,
};

/// Finds the modules that replace others in the shaders of a document. Those whose condition needs
/// a value of an include wait for it.
pub(super) fn replace<'a>(builder: &mut Builder<'a>, document: &'a Document, scope: ScopeId) {
    for entry in &document.imports {
        let at = builder.symbols.at(scope.begin(), None);
        if entry.items_of.is_some_and(|name| !at.is_provided(name)) {
            continue;
        }
        if waits(builder, entry, scope) {
            builder.waiting.push((scope, entry));
        } else {
            replace_one(builder, entry, scope);
        }
    }
}

/// Finds the modules whose conditions have got their values from an include; at the `end` of a
/// document all of its modules that are left.
pub(super) fn replace_waiting(builder: &mut Builder<'_>, end: Option<ScopeId>) {
    for (scope, entry) in std::mem::take(&mut builder.waiting) {
        if end != Some(scope) && waits(builder, entry, scope) {
            builder.waiting.push((scope, entry));
        } else {
            replace_one(builder, entry, scope);
        }
    }
}

fn replace_one(builder: &mut Builder<'_>, entry: &ImportEntry, scope: ScopeId) {
    let mut at = builder.symbols.at(scope.begin(), None);
    let condition = entry.condition.as_ref();
    // A condition without a value was reported.
    if builder.plan_inputs.is_there(condition, &mut at) == Ok(true) {
        let symbols = &mut builder.symbols;
        let instance = symbols.scopes.instance_of(scope);
        let replaced = &mut symbols.scopes.instance_mut(instance).replaced;
        let shaders = &symbols.graph.shaders;
        shaders.replace(replaced, &entry.of, &entry.is);
    }
}

/// True if the condition of a module needs a value that an include of the document gives and has
/// not given yet.
fn waits(builder: &Builder<'_>, entry: &ImportEntry, scope: ScopeId) -> bool {
    let mut waits = false;
    let mut check = |scope: ScopeId, leaf: Leaf<'_>| {
        let Instance {
            document, params, ..
        } = builder.symbols.scopes.document(scope);
        let name = leaf.named().filter(|name| params.bound(name).is_none());
        let gives = |name: &str| {
            let mut includes = document.includes();
            includes.any(|(_, _, inner)| inner.gives_values.contains(name))
        };
        waits |= name.is_some_and(gives);
    };
    if let Some(condition) = &entry.condition {
        builder.symbols.visit(scope, condition, &mut check);
    }
    waits
}
