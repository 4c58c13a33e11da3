//! Scopes: the meaning of names in a document. A document knows its own materials and inputs, the
//! outputs of its includes, and the names of provided resources. No other name crosses the border
//! between two documents.

use super::params::Params;
use crate::diagnostics::{ErrorGuaranteed, Reported};
use crate::document::{Document, Output};
use crate::language::{Name, wgsl_identifier};
use crate::resource::Target;
use crate::shader::Replaced;
use crate::source::Located;
use std::collections::{BTreeMap, HashMap};
use std::sync::Arc;

/// Index of a scope in [`Scopes`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct ScopeId(usize);

impl ScopeId {
    /// Returns the position of an expression in this scope that belongs to no entry, such as the
    /// size of a material.
    pub fn begin(self) -> Position {
        Position {
            scope: self,
            index: None,
        }
    }
}

/// Index of a value in [`SymbolTable`](super::symbols::SymbolTable).
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct ValueId(pub(super) usize);

/// Index of an instance of a document in [`Scopes`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct InstanceId(usize);

/// One use of a document in the graph: the root, or one include of it.
#[derive(Debug)]
pub(crate) struct Instance {
    /// Document that is used: the loaded one, or an included one.
    pub document: Arc<Document>,
    /// Params of the document with the values that they have in this use of it.
    pub params: Arc<Params>,
    /// Targets that the include binds to names of provided resources, by that name, such as
    /// `light`.
    pub scene: BTreeMap<String, Reported<Target>>,
    /// Place where the document is included; `None` for the loaded document.
    pub outer: Option<Outer>,
    /// Materials of the including document that the instance writes instead of its own: by name of
    /// its own material, the name in the `bind` with its place, and the target.
    pub overrides: BTreeMap<String, (Located<String>, Reported<Target>)>,
    /// WGSL modules that replace others in the instance's shaders.
    pub replaced: Replaced,
    /// Set if a part of the document could not be read. An unknown name may then be declared there
    /// and is not reported.
    pub incomplete: Option<ErrorGuaranteed>,
}

/// Place where a document is included, and prefixes of its names.
#[derive(Debug)]
pub(crate) struct Outer {
    pub scope: ScopeId,
    /// Prefix of the names of the document's outputs in the including document: `left.`,
    /// `lamp[2].`; `None` for an include without a name and repetition.
    pub namespace: Option<String>,
    /// Prefix of the full names of the document's passes, and of its materials that are not
    /// outputs: `soft.`.
    pub private: String,
}

/// Names that an instance of a document, or one repetition of a group in it, declares.
#[derive(Debug)]
struct Scope {
    instance: InstanceId,
    /// Scope around this one in the same document; `None` for the document's own.
    parent: Option<ScopeId>,
    /// Prefix of the scope's names in the document: `sample[3].`.
    path: String,
    names: Names,
    /// Targets and values by the spelling of their names in shaders, those in namespaces included.
    spellings: HashMap<String, Symbol>,
    /// Name of the repeated entry, and the index of this repetition.
    index: Option<(Name, u32)>,
}

/// Names of one scope or include, each with its meaning.
pub(crate) type Names = BTreeMap<Name, Symbol>;

/// Meaning of a name of a document.
#[derive(Clone, Debug)]
pub(crate) enum Symbol {
    Target(Target),
    /// A named expression.
    Value(ValueId),
    /// A name that is declared with a mistake.
    Invalid(ErrorGuaranteed),
    /// Names that a named include gives to the document around it.
    Namespace(Names),
    /// Names that each repetition of an entry gives, by index of the repetition.
    Repeated(Vec<Names>),
}

impl Symbol {
    /// Returns the meanings of `name` behind this symbol and a dot. A named include has at most
    /// one; a repeated entry has one for each repetition, in order; a target or value has none.
    pub fn named<'m>(&'m self, name: &Name) -> Vec<&'m Self> {
        match self {
            Self::Target(_) | Self::Value(_) | Self::Invalid(_) => Vec::new(),
            Self::Namespace(names) => names.get(name).into_iter().collect(),
            Self::Repeated(list) => list.iter().filter_map(|names| names.get(name)).collect(),
        }
    }
}

/// Position of an expression in a graph: its scope, and the index of the repetition if its entry is
/// repeated.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Position {
    pub scope: ScopeId,
    pub index: Option<u32>,
}

/// All scopes and instances of a graph.
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
            spellings: HashMap::new(),
            index,
        });
        ScopeId(self.scopes.len() - 1)
    }

    /// Returns the scope of the loaded document.
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

    /// Returns the use of a document that a scope belongs to.
    pub fn document(&self, scope: ScopeId) -> &Instance {
        self.instance(self.instance_of(scope))
    }

    /// Returns the prefix of a scope's names in its document, such as `sample[3].` in a repeated
    /// group; empty for the scope of the whole document.
    pub fn path(&self, scope: ScopeId) -> &str {
        &self.scopes[scope.0].path
    }

    /// Returns the full name of the material or value `name` of the instance `id` of a document:
    /// the name by which the loaded document knows it, or else the name with the includes and
    /// groups around the document in front.
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

    /// Returns the instance that includes another one; `None` for the root.
    fn parent(&self, id: InstanceId) -> Option<InstanceId> {
        let outer = self.instance(id).outer.as_ref()?;
        Some(self.instance_of(outer.scope))
    }

    /// Returns the names that were declared in a scope itself, not in the scopes around it.
    pub fn names(&self, scope: ScopeId) -> &Names {
        &self.scopes[scope.0].names
    }

    /// Returns a scope and those around it in its document, from the inside out.
    fn outwards(&self, id: ScopeId) -> impl Iterator<Item = &Scope> {
        std::iter::successors(Some(&self.scopes[id.0]), |scope| {
            scope.parent.map(|parent| &self.scopes[parent.0])
        })
    }

    /// Declares a name in a scope. A second declaration of a name is ignored here; it is reported
    /// where documents are read.
    pub fn declare(&mut self, scope: ScopeId, name: &Name, symbol: Symbol) {
        let scope = &mut self.scopes[scope.0];
        spell(&mut scope.spellings, wgsl_identifier(name), &symbol);
        scope.names.entry(name.clone()).or_insert(symbol);
    }

    /// Returns the meaning of `name` in a scope or the scopes around it in its document; `None` for
    /// an unknown name.
    pub fn find(&self, scope: ScopeId, name: &str) -> Option<&Symbol> {
        self.outwards(scope).find_map(|scope| scope.names.get(name))
    }

    /// Returns the target for a shader global, by its WGSL identifier; `None` if no name of the
    /// document has it.
    pub fn find_wgsl_name(&self, scope: ScopeId, identifier: &str) -> Option<Reported<Target>> {
        let mut scopes = self.outwards(scope);
        scopes.find_map(|scope| match scope.spellings.get(identifier)? {
            Symbol::Target(target) => Some(Ok(target.clone())),
            Symbol::Invalid(reported) => Some(Err(*reported)),
            _ => None,
        })
    }

    /// Returns the id of the named value `name`, or `left.edge` for the value `edge` of the include
    /// `left`; `None` if there is no such value.
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

    /// Returns the id of the named value for a shader's param or override, by its WGSL identifier;
    /// `None` if there is no such value.
    pub fn find_wgsl_value(&self, scope: ScopeId, identifier: &str) -> Option<ValueId> {
        let mut scopes = self.outwards(scope);
        scopes.find_map(|scope| match scope.spellings.get(identifier)? {
            Symbol::Value(id) => Some(*id),
            _ => None,
        })
    }

    /// Returns the index, from 0, of the innermost repetition around a position, or with `entry` of
    /// the repetition of the entry called `entry`; `None` outside of such a repetition.
    pub fn index(&self, position: Position, entry: Option<&Name>) -> Option<u32> {
        let own = position.index.filter(|_| entry.is_none());
        own.or_else(|| {
            self.outwards(position.scope).find_map(|scope| {
                let (name, index) = scope.index.as_ref()?;
                entry.is_none_or(|entry| entry == name).then_some(*index)
            })
        })
    }

    /// Returns every name that is declared in a scope or the scopes around it in its document;
    /// names that a named include gives have its name in front.
    pub fn known(&self, scope: ScopeId) -> Vec<String> {
        let mut names = Vec::new();
        for scope in self.outwards(scope) {
            list(&scope.names, "", &mut names);
        }
        names
    }

    /// Returns an instance and those that include it, from the inside out.
    fn outer_instances(&self, id: InstanceId) -> impl Iterator<Item = InstanceId> {
        std::iter::successors(Some(id), |id| self.parent(*id))
    }

    /// Returns the target that the innermost include around an instance binds to the name of a
    /// provided resource; `None` if no include binds the name.
    pub fn scene(&self, id: InstanceId, name: &str) -> Option<Reported<Target>> {
        self.outer_instances(id)
            .find_map(|id| self.instance(id).scene.get(name).cloned())
    }

    /// Returns all targets that includes around an instance bind to names of provided resources, by
    /// that name.
    pub fn bound_scene(&self, id: InstanceId) -> BTreeMap<String, Reported<Target>> {
        let mut bound = BTreeMap::new();
        for instance in self.outer_instances(id) {
            for (name, target) in &self.instance(instance).scene {
                bound.entry(name.clone()).or_insert_with(|| target.clone());
            }
        }
        bound
    }

    /// True if `inner` is `outer`, or is included in it directly or through other documents.
    pub fn is_within(&self, inner: InstanceId, outer: InstanceId) -> bool {
        self.outer_instances(inner).any(|id| id == outer)
    }
}

/// Notes the spelling in shaders of a name.
fn spell(spellings: &mut HashMap<String, Symbol>, spelling: String, symbol: &Symbol) {
    match symbol {
        Symbol::Target(_) | Symbol::Value(_) | Symbol::Invalid(_) => {
            spellings.entry(spelling).or_insert_with(|| symbol.clone());
        }
        Symbol::Namespace(names) => {
            for (name, symbol) in names {
                spell(spellings, format!("{spelling}_{name}"), symbol);
            }
        }
        Symbol::Repeated(list) => {
            for (index, names) in list.iter().enumerate() {
                for (name, symbol) in names {
                    spell(spellings, format!("{spelling}_{index}_{name}"), symbol);
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
