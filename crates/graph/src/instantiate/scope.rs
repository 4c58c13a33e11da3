//! Scopes: what a name means in a document, which may be included under a prefix, renamed, or several times.
//!
//! A name is looked for among the document's own, then among those of the document that includes it, and so on outwards.
//! What no scope knows is left as it is: a provided resource, or a mistake that the linker reports.

use crate::{
    document::located::Located,
    registry::Params,
    resolve::{previous, previous_of, spelling},
};
use std::{
    collections::{HashMap, HashSet},
    sync::Arc,
};

/// Index of a scope in [`Scopes`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct ScopeId(pub usize);

/// The names of one instance of a document, or of a group.
#[derive(Debug)]
pub(super) struct Scope {
    pub parent: Option<ScopeId>,
    /// What the names of passes and materials begin with in the whole graph.
    pub prefix: String,
    /// The materials are those of the including document: there is no prefix of one's own.
    pub joins: bool,
    /// The including document's names for some of the materials.
    pub renames: HashMap<String, Located<String>>,
    pub index: Option<u32>,
    pub params: Arc<Params>,
    /// The document's folder, where its shaders are looked for.
    pub folder: Arc<str>,
    names: HashMap<String, String>,
    /// Names as a shader spells them.
    spelt: HashMap<String, String>,
}

/// Where a material comes to stand.
pub(super) struct Place {
    /// Its name in the whole graph.
    pub full: String,
    /// The rename that makes it a material of an outer document; `None`: it is one of its own.
    pub connected: Option<Located<String>>,
    /// The scopes that it is handed through, from its document's own outwards, with its name in each.
    via: Vec<(ScopeId, String)>,
}

/// All scopes of a graph; the first is that of the root document.
#[derive(Debug)]
pub(crate) struct Scopes {
    list: Vec<Scope>,
    /// Names of what the host provides and imports.
    outside: HashSet<String>,
}

impl Scope {
    pub fn new(
        parent: Option<ScopeId>,
        prefix: String,
        params: Arc<Params>,
        folder: Arc<str>,
    ) -> Self {
        Self {
            parent,
            prefix,
            joins: false,
            renames: HashMap::new(),
            index: None,
            params,
            folder,
            names: HashMap::new(),
            spelt: HashMap::new(),
        }
    }

    fn insert(&mut self, name: &str, full: &str) {
        // The first of a name stays; a second one is reported where materials are declared.
        self.names
            .entry(name.to_owned())
            .or_insert_with(|| full.to_owned());
        self.spelt
            .entry(spelling(name))
            .or_insert_with(|| full.to_owned());
    }

    pub fn knows(&self, name: &str) -> bool {
        self.names.contains_key(name)
    }

    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.names.keys().map(String::as_str)
    }
}

/// Splits `name[N]`.
pub(crate) fn split_layer(name: &str) -> Option<(&str, u32)> {
    let (base, layer) = name.strip_suffix(']')?.rsplit_once('[')?;
    Some((base, layer.parse().ok()?))
}

/// The name with `[index]` replaced by the index of the repeat.
pub(super) fn indexed(name: &str, index: Option<u32>) -> String {
    match index {
        Some(index) => name.replace("[index]", &format!("[{index}]")),
        None => name.to_owned(),
    }
}

impl Scopes {
    pub(super) fn new(outside: HashSet<String>) -> Self {
        Self {
            list: Vec::new(),
            outside,
        }
    }

    pub(super) fn add(&mut self, scope: Scope) -> ScopeId {
        self.list.push(scope);
        ScopeId(self.list.len() - 1)
    }

    pub(super) fn get(&self, id: ScopeId) -> &Scope {
        &self.list[id.0]
    }

    /// The scope and those around it, from the inside out.
    fn outwards(&self, id: ScopeId) -> impl Iterator<Item = &Scope> {
        let around = |scope: &&Scope| scope.parent.map(|parent| self.get(parent));
        std::iter::successors(Some(self.get(id)), around)
    }

    /// The scope of the document around: groups have that document's params.
    pub(super) fn document(&self, id: ScopeId) -> &Scope {
        let scope = self.get(id);
        let within = |outer: &&Scope| Arc::ptr_eq(&outer.params, &scope.params);
        let last = self.outwards(id).take_while(within).last();
        last.unwrap_or(scope)
    }

    /// The index of the innermost repeat.
    pub fn index(&self, id: ScopeId) -> Option<u32> {
        self.outwards(id).find_map(|scope| scope.index)
    }

    /// What a name stands for in the whole graph, if a scope knows it; `name[N]` is a layer of `name`, unless a material is
    /// called just so.
    fn find(&self, id: ScopeId, name: &str) -> Option<String> {
        self.outwards(id).find_map(|scope| {
            if let Some(full) = scope.names.get(name) {
                return Some(full.clone());
            }
            let (base, layer) = split_layer(name)?;
            Some(format!("{}[{layer}]", scope.names.get(base)?))
        })
    }

    /// What a name in a document stands for in the whole graph.
    pub fn full_name(&self, id: ScopeId, index: Option<u32>, name: &str) -> String {
        if let Some(of) = previous_of(name) {
            return previous(&self.full_name(id, index, of));
        }
        let name = indexed(name, index);
        self.find(id, &name).unwrap_or(name)
    }

    /// All names that are known in a scope and not in the whole graph, sorted.
    pub fn names_within(&self, id: ScopeId) -> Vec<String> {
        let inner = self.outwards(id).filter(|scope| scope.parent.is_some());
        let mut names: Vec<String> = inner.flat_map(Scope::names).map(str::to_owned).collect();
        names.sort();
        names.dedup();
        names
    }

    /// What a shader's global of that name stands for in the whole graph, if a scope knows it.
    pub fn full_name_of_global(&self, id: ScopeId, global: &str) -> Option<&str> {
        self.outwards(id)
            .find_map(|scope| scope.names.get(global).or_else(|| scope.spelt.get(global)))
            .map(String::as_str)
    }

    /// Where a material that the document of a scope calls `name` comes to stand.
    pub(super) fn place(&self, mut id: ScopeId, name: &str) -> Place {
        let mut name = name.to_owned();
        let mut via = Vec::new();
        loop {
            let scope = self.get(id);
            via.push((id, name.clone()));
            match (scope.parent, scope.renames.get(&name)) {
                (Some(parent), Some(outer)) => {
                    let outside = || self.outside.get(outer.as_str()).cloned();
                    if let Some(full) = self.find(parent, outer).or_else(outside) {
                        let connected = Some(outer.clone());
                        return Place {
                            full,
                            connected,
                            via,
                        };
                    }
                    name = outer.value.clone();
                    id = parent;
                }
                (Some(parent), None) if scope.joins => id = parent,
                (parent, _) => {
                    let full = format!("{}{name}", scope.prefix);
                    match self.renamed_around(parent, &full) {
                        Some(renamed) => (id, name) = renamed,
                        None => {
                            return Place {
                                full,
                                connected: None,
                                via,
                            };
                        }
                    }
                }
            }
        }
    }

    /// The document around that was given another name for what it knows as `prefix.name`, and that name.
    fn renamed_around(&self, mut around: Option<ScopeId>, full: &str) -> Option<(ScopeId, String)> {
        while let Some(id) = around {
            let scope = self.get(id);
            let rest = full.strip_prefix(&scope.prefix)?;
            if scope.renames.contains_key(rest) {
                return Some((id, rest.to_owned()));
            }
            around = scope.parent;
        }
        None
    }

    /// Makes a material known under its name in each scope that it is handed through, and around these under what is left
    /// of its full name.
    pub(super) fn publish(&mut self, place: &Place) {
        for (id, name) in &place.via {
            self.list[id.0].insert(name, &place.full);
        }
        if place.connected.is_some() {
            return;
        }
        let mut around = place.via.last().map(|(id, _)| *id);
        while let Some(id) = around {
            let scope = &mut self.list[id.0];
            around = scope.parent;
            if let Some(rest) = place.full.strip_prefix(&scope.prefix) {
                let rest = rest.to_owned();
                scope.insert(&rest, &place.full);
            }
        }
    }

    /// Makes a material with a mistake known to its document alone, and returns its full name.
    pub(super) fn hide(&mut self, id: ScopeId, name: &str) -> String {
        let scope = &mut self.list[id.0];
        let full = format!("{}{name}", scope.prefix);
        scope.insert(name, &full);
        full
    }
}
