//! Meaning of names in a document: its own materials and inputs, and names from its includes and
//! the scene. Nothing else crosses the border between two documents.

use super::params::Params;
use crate::{
    diagnostics::reports::{ErrorGuaranteed, Reported},
    document::typed::{Document, Output},
    language::name::{Name, wgsl_identifier},
    resource::Target,
    shader::expand::Replaced,
    source::span::Located,
};
use std::{
    collections::{BTreeMap, HashMap},
    sync::Arc,
};

/// Number of a frame in [`Scopes`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct ScopeId(usize);

impl ScopeId {
    /// The place of an expression that is no entry's.
    pub fn begin(self) -> Position {
        Position {
            scope: self,
            index: None,
        }
    }
}

/// Number of a value in [`SymbolTable`](super::symbols::SymbolTable).
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct ValueId(pub(super) usize);

/// Number of an instance of a document in [`Scopes`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct InstanceId(usize);

/// A document as it stands in the graph once.
#[derive(Debug)]
pub(crate) struct Instance {
    pub document: Arc<Document>,
    pub params: Arc<Params>,
    /// Targets of names of the scene in here, besides those from the scene itself.
    pub scene: BTreeMap<String, Reported<Target>>,
    /// Where it is included; `None` for the root.
    pub outer: Option<Outer>,
    /// The materials outside that are written instead of its own ones, with the place that says so.
    pub overrides: BTreeMap<String, (Located<String>, Reported<Target>)>,
    /// Modules that stand in for others in its shaders.
    pub replaced: Replaced,
    /// Something in it could not be read, so that unknown names are no mistakes.
    pub incomplete: Option<ErrorGuaranteed>,
}

/// Where a document is included.
#[derive(Debug)]
pub(crate) struct Outer {
    pub scope: ScopeId,
    /// Prefix of the names of its outputs there: `left.`, `lamp[2].`.
    pub namespace: Option<String>,
    /// Prefix of the full names of everything else in it.
    pub private: String,
}

/// The names of an instance of a document, or of one repetition of a group in it.
#[derive(Debug)]
struct Scope {
    instance: InstanceId,
    /// The frame around it in the same document.
    parent: Option<ScopeId>,
    /// Prefix of its names in the document: `sample[3].`.
    path: String,
    names: Names,
    /// Their spellings in shaders, those of parts of namespaces included.
    wgsl_name: HashMap<String, Reported<Target>>,
    /// The same of values.
    wgsl_values: HashMap<String, ValueId>,
    /// The repeated entry, and which repetition this is.
    index: Option<(Name, u32)>,
}

/// Names and what they mean.
pub(crate) type Names = BTreeMap<Name, Symbol>;

/// Meaning of a name of a document.
#[derive(Clone, Debug)]
pub(crate) enum Symbol {
    Target(Target),
    /// A named expression.
    Value(ValueId),
    /// Declared with a mistake.
    Invalid(ErrorGuaranteed),
    /// Names that a named include gives.
    Namespace(Names),
    /// Names that each repetition of an entry gives.
    Repeated(Vec<Names>),
}

impl Symbol {
    /// Returns the meanings of a name behind a dot: of repetitions, one for each of them.
    pub fn named<'m>(&'m self, name: &Name) -> Vec<&'m Self> {
        match self {
            Self::Target(_) | Self::Value(_) | Self::Invalid(_) => Vec::new(),
            Self::Namespace(names) => names.get(name).into_iter().collect(),
            Self::Repeated(list) => list.iter().filter_map(|names| names.get(name)).collect(),
        }
    }
}

/// Where an expression stands: the frame, and the index of its own entry if that is repeated.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Position {
    pub scope: ScopeId,
    pub index: Option<u32>,
}

/// All frames of a graph.
#[derive(Debug, Default)]
pub(crate) struct Scopes {
    scopes: Vec<Scope>,
    instances: Vec<Instance>,
}

impl Scopes {
    pub fn add_instance(&mut self, instance: Instance) -> InstanceId {
        self.instances.push(instance);
        InstanceId(self.instances.len() - 1)
    }

    pub fn add_scope(
        &mut self,
        instance: InstanceId,
        parent: Option<ScopeId>,
        path: String,
        index: Option<(Name, u32)>,
    ) -> ScopeId {
        self.scopes.push(Scope {
            instance,
            parent,
            path,
            names: Names::new(),
            wgsl_name: HashMap::new(),
            wgsl_values: HashMap::new(),
            index,
        });
        ScopeId(self.scopes.len() - 1)
    }

    /// The frame of the root document.
    pub fn root(&self) -> ScopeId {
        ScopeId(0)
    }

    pub fn instance_of(&self, scope: ScopeId) -> InstanceId {
        self.scopes[scope.0].instance
    }

    pub fn instance(&self, id: InstanceId) -> &Instance {
        &self.instances[id.0]
    }

    pub fn instance_mut(&mut self, id: InstanceId) -> &mut Instance {
        &mut self.instances[id.0]
    }

    /// The instance of the document that a frame is of.
    pub fn document(&self, scope: ScopeId) -> &Instance {
        self.instance(self.instance_of(scope))
    }

    /// Returns the prefix of a frame's names in its document.
    pub fn path(&self, scope: ScopeId) -> &str {
        &self.scopes[scope.0].path
    }

    /// The full name of what a document calls `name`: the outermost name by which it is known.
    pub fn full_name(&self, id: InstanceId, name: &str) -> String {
        let instance = self.instance(id);
        let Some(outer) = &instance.outer else {
            return name.to_owned();
        };
        let is_it = |output: &&Output| output.material.text() == name;
        match instance.document.outputs.iter().find(is_it) {
            Some(output) => {
                let path = self.path(outer.scope);
                let namespace = outer.namespace.as_deref().unwrap_or("");
                let outside = format!("{path}{namespace}{}", output.name.value);
                self.full_name(self.instance_of(outer.scope), &outside)
            }
            None => format!("{}{name}", outer.private),
        }
    }

    /// The instance around another one.
    fn parent(&self, id: InstanceId) -> Option<InstanceId> {
        let outer = self.instance(id).outer.as_ref()?;
        Some(self.instance_of(outer.scope))
    }

    /// The names that were declared in a frame itself.
    pub fn names(&self, scope: ScopeId) -> &Names {
        &self.scopes[scope.0].names
    }

    /// The frame and those around it in its document, from the inside out.
    fn outwards(&self, id: ScopeId) -> impl Iterator<Item = &Scope> {
        std::iter::successors(Some(&self.scopes[id.0]), |scope| {
            scope.parent.map(|parent| &self.scopes[parent.0])
        })
    }

    /// The first of a name stays; a second one is reported where documents are read.
    pub fn declare(&mut self, scope: ScopeId, name: &Name, symbol: Symbol) {
        let scope = &mut self.scopes[scope.0];
        spell(scope, &wgsl_identifier(name), &symbol);
        scope.names.entry(name.clone()).or_insert(symbol);
    }

    pub fn find(&self, scope: ScopeId, name: &str) -> Option<&Symbol> {
        self.outwards(scope).find_map(|scope| scope.names.get(name))
    }

    /// Finds the target of a shader's global by its spelling.
    pub fn find_wgsl_name(&self, scope: ScopeId, identifier: &str) -> Option<Reported<Target>> {
        self.outwards(scope)
            .find_map(|scope| scope.wgsl_name.get(identifier).cloned())
    }

    /// The value of that name; of a named include with a dot, `left.edge`.
    pub fn find_value(&self, scope: ScopeId, name: &str) -> Option<ValueId> {
        let mut parts = name.split('.');
        let mut symbol = self.find(scope, parts.next()?)?;
        for part in parts {
            let Symbol::Namespace(names) = symbol else {
                return None;
            };
            symbol = names.get(part)?;
        }
        match symbol {
            Symbol::Value(id) => Some(*id),
            _ => None,
        }
    }

    /// The value that a shader's param or override of that spelling is.
    pub fn find_wgsl_value(&self, scope: ScopeId, identifier: &str) -> Option<ValueId> {
        self.outwards(scope)
            .find_map(|scope| scope.wgsl_values.get(identifier).copied())
    }

    /// The index of the innermost repetition, or of that of a named entry.
    pub fn index(&self, position: Position, of: Option<&Name>) -> Option<u32> {
        let own = position.index.filter(|_| of.is_none());
        own.or_else(|| {
            self.outwards(position.scope).find_map(|scope| {
                let (name, index) = scope.index.as_ref()?;
                of.is_none_or(|of| of == name).then_some(*index)
            })
        })
    }

    /// Every name that is known in a frame, with those of namespaces.
    pub fn known(&self, scope: ScopeId) -> Vec<String> {
        let mut known = Vec::new();
        for scope in self.outwards(scope) {
            list(&scope.names, "", &mut known);
        }
        known
    }

    /// An instance and those around it, from the inside out.
    fn outer_instances(&self, id: InstanceId) -> impl Iterator<Item = InstanceId> {
        std::iter::successors(Some(id), |id| self.parent(*id))
    }

    /// The resource that a name of the scene stands for in an instance, where an include says so.
    pub fn scene(&self, id: InstanceId, name: &str) -> Option<Reported<Target>> {
        self.outer_instances(id)
            .find_map(|id| self.instance(id).scene.get(name).cloned())
    }

    /// Returns the targets of names of the scene in an instance.
    pub fn bound_scene(&self, id: InstanceId) -> BTreeMap<String, Reported<Target>> {
        let mut bound = BTreeMap::new();
        for instance in self.outer_instances(id) {
            for (name, target) in &self.instance(instance).scene {
                bound.entry(name.clone()).or_insert_with(|| target.clone());
            }
        }
        bound
    }

    /// True if one instance stands in another one.
    pub fn is_within(&self, inner: InstanceId, outer: InstanceId) -> bool {
        self.outer_instances(inner).any(|id| id == outer)
    }
}

/// Notes how shaders spell what a name means.
fn spell(scope: &mut Scope, spelling: &str, symbol: &Symbol) {
    match symbol {
        Symbol::Target(target) => {
            scope
                .wgsl_name
                .entry(spelling.to_owned())
                .or_insert_with(|| Ok(target.clone()));
        }
        Symbol::Value(id) => {
            scope.wgsl_values.entry(spelling.to_owned()).or_insert(*id);
        }
        Symbol::Invalid(reported) => {
            let names = scope.wgsl_name.entry(spelling.to_owned());
            names.or_insert(Err(*reported));
        }
        Symbol::Namespace(names) => {
            for (name, symbol) in names {
                spell(scope, &format!("{spelling}_{name}"), symbol);
            }
        }
        Symbol::Repeated(list) => {
            for (index, names) in list.iter().enumerate() {
                for (name, symbol) in names {
                    spell(scope, &format!("{spelling}_{index}_{name}"), symbol);
                }
            }
        }
    }
}

fn list(names: &Names, prefix: &str, into: &mut Vec<String>) {
    for (name, symbol) in names {
        match symbol {
            Symbol::Target(_) | Symbol::Value(_) | Symbol::Invalid(_) => {
                into.push(format!("{prefix}{name}"))
            }
            Symbol::Namespace(inner) => list(inner, &format!("{prefix}{name}."), into),
            Symbol::Repeated(inner) => {
                if let Some(first) = inner.first() {
                    list(first, &format!("{prefix}{name}[0]."), into);
                }
            }
        }
    }
}
