//! Settings of groups, which the entries inside inherit: bindings and values for names of shaders
//! and included documents.

use super::scopes::Position;
use crate::document::Entry;
use crate::language::{Expr, Reference};
use crate::source::Located;

/// A `bind` or `set` with the position at which its expressions are evaluated.
#[derive(Clone)]
pub(crate) struct Inherited<'a, T> {
    pub name: &'a Located<String>,
    pub value: &'a T,
    pub position: Position,
}

/// Bindings and values of an entry and the groups around it, an inner one's in place of an outer
/// one's.
#[derive(Clone, Default)]
pub(crate) struct Settings<'a> {
    pub bind: Vec<Inherited<'a, Reference>>,
    pub set: Vec<Inherited<'a, Expr>>,
}

impl<'a> Settings<'a> {
    /// Returns the settings that an entry has itself.
    pub fn own(entry: &'a Entry, position: Position) -> Self {
        Self {
            bind: at(&entry.bind, position),
            set: at(&entry.set, position),
        }
    }

    /// Adds the settings of groups around for the names that are not set here.
    #[must_use]
    pub fn within(mut self, outer: &Self) -> Self {
        add(&mut self.bind, &outer.bind);
        add(&mut self.set, &outer.set);
        self
    }

    /// Returns the names that are set, each at its place in a document.
    pub fn names(&self) -> impl Iterator<Item = &'a Located<String>> {
        let bind = self.bind.iter().map(|setting| setting.name);
        bind.chain(self.set.iter().map(|setting| setting.name))
    }
}

fn at<T>(own: &[(Located<String>, T)], position: Position) -> Vec<Inherited<'_, T>> {
    let own = own.iter().map(|(name, value)| Inherited {
        name,
        value,
        position,
    });
    own.collect()
}

fn add<'a, T: Clone>(inner: &mut Vec<Inherited<'a, T>>, outer: &[Inherited<'a, T>]) {
    let is_free = |it: &&Inherited<'_, T>| inner.iter().all(|own| **own.name != **it.name);
    let free: Vec<_> = outer.iter().filter(is_free).cloned().collect();
    inner.extend(free);
}
