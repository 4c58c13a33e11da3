//! Phase 2: the tree of entries becomes one list of passes and one of materials, each with its name in the whole graph.
//!
//! Pass bodies are opaque, so they are lowered with the names that their document uses, and the names in their steps are
//! translated afterwards. How often something is repeated follows params, hence this is done for every plan.

mod bind;
mod materials;
mod scope;
#[cfg(test)]
mod tests;

use crate::{
    diagnostics::{Code, Diagnostic},
    document::{
        Document, Entry, GroupEntry, IncludeEntry, PassEntry, Run, located::Located,
        materials::Material, params::ParamValue, value::Value,
    },
    registry::{Lowering, Params},
    source::{Span, folder_of},
    step::Step,
};
use scope::{Scope, indexed};
pub(crate) use scope::{ScopeId, Scopes, split_layer};
use std::{
    collections::{BTreeMap, HashMap, HashSet},
    sync::Arc,
};

/// Most passes (groups and includes among them), and most materials, of a graph. A guard against documents that
/// double with each include: what is above takes memory and time that nobody means to spend.
const MOST: usize = 16_384;

/// A graph with nothing nested any more.
#[derive(Debug)]
pub(crate) struct Instance {
    pub materials: Vec<Material>,
    /// Names of materials with a mistake that was reported.
    pub unread: Vec<String>,
    pub passes: Vec<LoweredPass>,
    /// What the names begin with that includes with a mistake would have brought; empty for any name.
    pub hidden: Vec<String>,
    /// How many passes stand above the first entry with a mistake that was reported.
    pub first_broken: Option<usize>,
    /// The root document's params.
    pub params: Arc<Params>,
    pub fallbacks: Vec<Fallback>,
}

/// A param that got another value because the device lacks a feature.
#[derive(Clone, Debug, PartialEq)]
pub struct Fallback {
    /// wgpu's name of the feature.
    pub feature: String,
    /// The param's name, with the prefix of the include.
    pub param: String,
    /// The value it would have had.
    pub instead_of: ParamValue,
    /// The value it has.
    pub value: ParamValue,
}

/// A pass with its body lowered to steps, every name one of the whole graph.
#[derive(Debug)]
pub(crate) struct LoweredPass {
    pub name: Located<String>,
    pub kind: &'static str,
    /// The name in `When` is the root document's for the param, or has the prefix of its document: equal conditions are equal.
    pub run: Run,
    /// The value of the param in `When`; true without one.
    pub enabled: bool,
    pub overwrites: Vec<Located<String>>,
    pub steps: Vec<Step>,
    pub scratch: Vec<(String, u64)>,
    pub scope: PassScope,
}

/// What the names in a pass's shaders mean.
#[derive(Clone, Debug)]
pub(crate) struct PassScope {
    scopes: Arc<Scopes>,
    id: ScopeId,
    /// The params of the document that the pass stands in.
    pub params: Arc<Params>,
    /// The index of the innermost repeat around the pass.
    pub index: Option<u32>,
    /// Where its shaders are looked for.
    pub folder: Arc<str>,
    /// The pass's name in its document, which is also that of its shader.
    pub own_name: String,
}

impl PassScope {
    /// What a global of a shader stands for in the whole graph.
    pub fn global<'a>(&'a self, name: &'a str) -> &'a str {
        let known = self.scopes.full_name_of_global(self.id, name);
        known.unwrap_or(name)
    }

    /// The names that its document has besides those of the whole graph, sorted.
    pub fn names(&self) -> Vec<String> {
        self.scopes.names_within(self.id)
    }
}

/// What a document is instantiated for.
pub(crate) enum Purpose<'a> {
    /// To find all shaders and mistakes: whatever may be repeated is there once at least.
    Load,
    /// To be planned.
    Plan {
        values: &'a BTreeMap<String, ParamValue>,
        /// Those that the device has.
        features: wgpu::Features,
        /// Names of what the host provides and imports.
        outside: HashSet<String>,
    },
}

/// Flattens a document with all that it includes.
pub(crate) fn instantiate(
    document: &Document,
    purpose: Purpose<'_>,
    diagnostics: &mut Vec<Diagnostic>,
) -> Instance {
    let none = BTreeMap::new();
    let (values, features, outside) = match purpose {
        Purpose::Load => (&none, None, HashSet::new()),
        Purpose::Plan {
            values,
            features,
            outside,
        } => (values, Some(features), outside),
    };
    let mut builder = Builder {
        features,
        scopes: Scopes::new(outside),
        materials: Vec::new(),
        declared: HashMap::new(),
        unread: Vec::new(),
        hidden: Vec::new(),
        passes: Vec::new(),
        first_broken: None,
        fallbacks: Vec::new(),
        spent: 0,
        is_full: false,
        diagnostics,
    };
    let mut params = bind::root(&document.params, values);
    builder.require(document, &mut params, "");
    let params = Arc::new(params);
    let folder = folder_of(&document.file.name).into();
    let root = Scope::new(None, String::new(), Arc::clone(&params), folder);
    let root = builder.scopes.add(root);
    builder.document(document, root);
    builder.finish(params)
}

struct PendingPass<'a> {
    entry: &'a PassEntry,
    name: String,
    scope: ScopeId,
    index: Option<u32>,
}

struct Builder<'a, 'd> {
    features: Option<wgpu::Features>,
    scopes: Scopes,
    /// Each with the scope that its own names are of.
    materials: Vec<(Material, ScopeId)>,
    /// Materials and views by their names in the whole graph: the place, and the index in `materials`.
    declared: HashMap<String, (Span, usize)>,
    unread: Vec<String>,
    hidden: Vec<String>,
    passes: Vec<PendingPass<'a>>,
    first_broken: Option<usize>,
    fallbacks: Vec<Fallback>,
    spent: usize,
    is_full: bool,
    diagnostics: &'d mut Vec<Diagnostic>,
}

impl<'a> Builder<'a, '_> {
    fn document(&mut self, document: &'a Document, scope: ScopeId) {
        self.declare(document, scope);
        self.entries(&document.entries, scope);
    }

    fn entries(&mut self, entries: &'a [Entry], scope: ScopeId) {
        for entry in entries {
            match entry {
                Entry::Pass(pass) => self.pass(pass, scope),
                Entry::Group(group) => self.group(group, scope),
                Entry::Include(include) => match &include.document {
                    Some(document) => self.include(include, document, scope),
                    None => self.hidden(include.prefix.as_ref(), scope),
                },
                Entry::BrokenInclude => self.hidden(None, scope),
                Entry::Broken => self.broken(),
            }
        }
    }

    fn broken(&mut self) {
        let above = self.passes.len();
        self.first_broken.get_or_insert(above);
    }

    /// An include with a mistake: what it would have brought is not known.
    fn hidden(&mut self, prefix: Option<&Located<String>>, scope: ScopeId) {
        self.broken();
        let around = &self.scopes.get(scope).prefix;
        let prefix = prefix.map_or("", |prefix| prefix);
        self.hidden.push(format!("{around}{prefix}"));
    }

    /// The indices of the instances of an entry.
    fn instances(
        &mut self,
        name: &Located<String>,
        repeat: Option<&Located<Value<u32>>>,
        scope: ScopeId,
    ) -> Vec<Option<u32>> {
        let number = match repeat {
            None => 1,
            Some(repeat) => {
                let params = Arc::clone(&self.scopes.get(scope).params);
                match params.value(&repeat.value, self.diagnostics) {
                    // Loaded without a device, once: its shaders may be needed for other values.
                    Some(number) if self.features.is_none() => number.max(1),
                    Some(number) => number,
                    None => {
                        self.broken();
                        return Vec::new();
                    }
                }
            }
        };
        self.spent = self.spent.saturating_add(number as usize);
        if self.spent > MOST {
            self.full(name, "passes");
            return Vec::new();
        }
        match repeat {
            None => vec![None],
            Some(_) => (0..number).map(Some).collect(),
        }
    }

    /// Says once that there is no room for more.
    fn full(&mut self, name: &Located<String>, what: &str) {
        self.broken();
        if !std::mem::replace(&mut self.is_full, true) {
            self.diagnostics.push(
                Diagnostic::error(Code::Size, format!("the graph has more than 16,384 {what}"))
                    .at(name.span.clone(), "counted up to here")
                    .help("repeat or include less"),
            );
        }
    }

    fn pass(&mut self, entry: &'a PassEntry, scope: ScopeId) {
        for index in self.instances(&entry.name, entry.repeat.as_ref(), scope) {
            let prefix = &self.scopes.get(scope).prefix;
            let pass = PendingPass {
                entry,
                name: format!("{prefix}{}{}", *entry.name, suffix(index)),
                scope,
                index: index.or_else(|| self.scopes.index(scope)),
            };
            self.passes.push(pass);
        }
    }

    fn group(&mut self, group: &'a GroupEntry, scope: ScopeId) {
        for index in self.instances(&group.name, group.repeat.as_ref(), scope) {
            let around = self.scopes.get(scope);
            let prefix = format!("{}{}{}.", around.prefix, *group.name, suffix(index));
            let (params, folder) = (Arc::clone(&around.params), Arc::clone(&around.folder));
            let mut inner = Scope::new(Some(scope), prefix, params, folder);
            inner.index = index;
            let inner = self.scopes.add(inner);
            self.entries(&group.entries, inner);
        }
    }

    fn include(&mut self, include: &'a IncludeEntry, document: &'a Document, scope: ScopeId) {
        for index in self.instances(&include.graph, include.repeat.as_ref(), scope) {
            let prefix = match &include.prefix {
                Some(prefix) => format!(
                    "{}{}{}.",
                    self.scopes.get(scope).prefix,
                    **prefix,
                    suffix(index)
                ),
                None => self.scopes.get(scope).prefix.clone(),
            };
            let mut params = self.bind(include, document, scope);
            self.require(document, &mut params, &prefix);
            // A param that fell back is not the root's any more.
            let root = Arc::clone(&self.scopes.get(ScopeId(0)).params);
            for bound in &mut params.list {
                let of_root =
                    |name: &mut String| root.bound(name).map(|of| &of.value) != Some(&bound.value);
                bound.root.take_if(of_root);
            }
            let folder = folder_of(&document.file.name).into();
            let mut inner = Scope::new(Some(scope), prefix, Arc::new(params), folder);
            inner.joins = include.prefix.is_none();
            inner.index = index;
            let shown = index.or_else(|| self.scopes.index(scope));
            let renames = include.materials.iter().map(|(name, outer)| {
                let outer = Located::new(indexed(outer, shown), outer.span.clone());
                (name.value.clone(), outer)
            });
            inner.renames = renames.collect();
            let inner = self.scopes.add(inner);
            self.document(document, inner);
            self.check_renames(include, document, inner);
        }
    }

    /// Every pass is lowered, every name translated.
    fn finish(mut self, params: Arc<Params>) -> Instance {
        self.unique_passes();
        let materials = self.settle_materials();
        let scopes = Arc::new(self.scopes);
        let mut passes = Vec::new();
        for pending in self.passes {
            passes.push(lower(&pending, &scopes, self.diagnostics));
        }
        Instance {
            materials,
            unread: self.unread,
            hidden: self.hidden,
            passes,
            first_broken: self.first_broken,
            params,
            fallbacks: self.fallbacks,
        }
    }

    fn unique_passes(&mut self) {
        let mut seen: HashMap<&str, &Span> = HashMap::new();
        for pass in &self.passes {
            let place = &pass.entry.name.span;
            match seen.get(pass.name.as_str()) {
                Some(first) => self
                    .diagnostics
                    .push(clash("pass", &pass.name, first, place)),
                None => {
                    seen.insert(&pass.name, place);
                }
            }
        }
    }
}

fn suffix(index: Option<u32>) -> String {
    index.map_or(String::new(), |index| format!("[{index}]"))
}

/// Two things of one name in the whole graph.
fn clash(what: &str, name: &str, first: &Span, second: &Span) -> Diagnostic {
    let error = Diagnostic::error(
        Code::DuplicateName,
        format!("two of the name `{name}`: every {what} needs its own"),
    );
    if first == second {
        return error
            .at(second.clone(), "it stands in the graph twice")
            .help("give each include of the document a `prefix` of its own");
    }
    let error = error
        .at(second.clone(), "the second one")
        .at(first.clone(), "the first one");
    match (first.file == second.file, what) {
        (true, _) => error,
        (false, "material") => error.help(format!(
            "include the document with a `prefix`, or connect the two: `materials: {{\"{name}\": \"{name}\"}}`"
        )),
        (false, _) => error.help("include the document with a `prefix`"),
    }
}

fn lower(
    pending: &PendingPass<'_>,
    scopes: &Arc<Scopes>,
    diagnostics: &mut Vec<Diagnostic>,
) -> LoweredPass {
    let entry = pending.entry;
    let scope = scopes.get(pending.scope);
    let mut lowering = Lowering {
        name: &entry.name,
        shader: entry.shader.as_ref(),
        bind: &entry.bind,
        params: &scope.params,
        steps: Vec::new(),
        scratch: Vec::new(),
        diagnostics: Vec::new(),
    };
    entry.body.lower(&mut lowering);
    diagnostics.append(&mut lowering.diagnostics);
    let (mut run, mut enabled) = (entry.run.clone(), true);
    if let Run::When(name) = &mut run {
        let condition = Value::Param(name.clone());
        enabled = scope.params.value(&condition, diagnostics).unwrap_or(true);
        let root = scope
            .params
            .bound(name)
            .and_then(|bound| bound.root.clone());
        name.value = root.unwrap_or_else(|| {
            let document = scopes.document(pending.scope);
            let file = &entry.name.span.file.name;
            match document.joins {
                // Its prefix is that of the document around, which may have a param of this name.
                true => format!("{}{} of {file}", document.prefix, name.value),
                false => format!("{}{}", document.prefix, name.value),
            }
        });
    }
    let (mut steps, mut overwrites) = (lowering.steps, entry.overwrites.clone());
    // A pass's own buffers begin with its name, whatever that is in the whole graph.
    let scratch: HashMap<String, (String, u64)> = lowering
        .scratch
        .into_iter()
        .map(|(name, bytes)| {
            let rest = name.strip_prefix(entry.name.as_str()).unwrap_or(&name);
            let full = format!("{}{rest}", pending.name);
            (name, (full, bytes))
        })
        .collect();
    let mut translate = |name: &mut Located<String>| {
        name.value = match scratch.get(&name.value) {
            Some((full, _)) => full.clone(),
            None => scopes.full_name(pending.scope, pending.index, name),
        };
    };
    steps.iter_mut().for_each(|step| step.names(&mut translate));
    overwrites.iter_mut().for_each(translate);
    let mut scratch: Vec<(String, u64)> = scratch.into_values().collect();
    scratch.sort();
    LoweredPass {
        name: Located::new(pending.name.clone(), entry.name.span.clone()),
        kind: entry.kind,
        run,
        enabled,
        overwrites,
        steps,
        scratch,
        scope: PassScope {
            scopes: Arc::clone(scopes),
            id: pending.scope,
            params: Arc::clone(&scope.params),
            index: pending.index,
            folder: Arc::clone(&scope.folder),
            own_name: entry.name.value.clone(),
        },
    }
}
