//! Flattens documents: walks their entries and resolves conditions, repetitions, groups and
//! includes.

use super::flat::{EntryContext, Flat, FlatPass, Interface, Merge, PlanInputs, Round, Run};
use super::imports;
use super::include::{self, Call};
use super::merge::{Asks, Content, Site};
use super::modules::WaitingModules;
use super::params::Params;
use super::runs::runs;
use super::scopes::{Instance, InstanceId, Names, Position, ScopeId, Symbol};
use super::settings::Settings;
use super::state::{Declared, DeclaredValue, ValueState};
use super::symbols::SymbolTable;
use crate::compose::Loaded;
use crate::diagnostics::{ErrorGuaranteed, Reported, Reports};
use crate::document::{Document, Entry, Include, Invalid, Pass, What};
use crate::errors::instantiate::InterfaceError;
use crate::expressions::eval;
use crate::language::{Name, Reference};
use crate::param::ParamType;
use crate::request::PlanRequest;
use crate::resource::{Origin, Resource, ResourceId, ResourceKind};
use crate::shader::{Replaced, Shader};
use crate::source::{Located, Span};
use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::sync::Arc;

/// Greatest number of passes (groups and includes among them), and of materials, of a graph. It
/// guards against documents that double with each include, which would take absurd time and memory.
const MOST: usize = 16_384;

pub(super) struct Builder<'a> {
    pub symbols: SymbolTable<'a>,
    pub(super) passes: Vec<FlatPass<'a>>,
    first_invalid: Option<usize>,
    pub interfaces: Vec<Interface>,
    plan_inputs: PlanInputs,
    /// True if includes of the same content are merged.
    pub(super) merges: bool,
    pub(super) sites: Vec<Site>,
    /// By address of the document.
    asks: HashMap<*const Document, Asks>,
    pub(super) merged: Vec<Merge>,
    waiting: WaitingModules<'a>,
    /// Settings of groups by address of their names.
    said: BTreeMap<*const Located<String>, GroupSetting<'a>>,
    spent: usize,
    full: Option<ErrorGuaranteed>,
    /// Number of frames after which all run conditions so far repeat.
    period: u64,
}

/// Name of a group, name of its setting, and true if an entry in the group uses it.
pub(super) type GroupSetting<'a> = (&'a Located<Name>, &'a Located<String>, bool);

/// Flattens a document with all that it includes. `merges`: includes of the same content are
/// merged.
pub(crate) fn flatten<'a>(
    graph: &'a Loaded,
    request: &'a PlanRequest<'a>,
    params: Params,
    merges: bool,
    reports: Reports,
) -> (Flat<'a>, Vec<FlatPass<'a>>) {
    let mut builder = Builder {
        symbols: SymbolTable::new(graph, request, reports),
        passes: Vec::new(),
        first_invalid: None,
        interfaces: Vec::new(),
        plan_inputs: PlanInputs::default(),
        merges,
        sites: Vec::new(),
        asks: HashMap::new(),
        merged: Vec::new(),
        waiting: WaitingModules::default(),
        said: BTreeMap::new(),
        spent: 0,
        full: None,
        period: 1,
    };
    let document = &graph.document;
    let instance = builder.symbols.scopes.add_instance(Instance {
        document: Arc::clone(document),
        params: Arc::new(params),
        scene: BTreeMap::new(),
        outer: None,
        overrides: BTreeMap::new(),
        replaced: Replaced::new(),
        incomplete: None,
    });
    let scopes = &mut builder.symbols.scopes;
    let scope = scopes.add_scope(instance, None, String::new(), None);
    builder.require(document);
    builder.imports(document, scope);
    builder.document(document, &EntryContext::new(scope));
    builder.root_interface(document, instance, scope);
    builder.finish()
}

impl<'a> Builder<'a> {
    /// Reports the features that a document requires and the request's device lacks.
    pub fn require(&mut self, document: &Document) {
        for (feature, flag) in &document.requires {
            if !self.symbols.request.features.contains(*flag) {
                let document = document.file.name.to_string();
                let error = InterfaceError::Feature(document, feature.clone());
                // The report suffices: nothing here depends on the result.
                let _ = self.symbols.reports.unsupported(error);
            }
        }
    }

    /// Declares the inputs of the root document as the host's imports.
    fn imports(&mut self, document: &Document, scope: ScopeId) {
        for input in &document.inputs {
            let symbol = imports::imported(input, &mut self.symbols.at(scope.begin(), None));
            self.symbols
                .scopes
                .declare(scope, &input.name.value, symbol);
        }
    }

    /// Declares the values and materials of a document, then walks its entries.
    pub fn document(&mut self, document: &'a Arc<Document>, context: &EntryContext<'a>) {
        let scope = context.scope;
        for (name, reported) in &document.broken_materials {
            match Name::new(name) {
                Ok(name) => {
                    let symbol = Symbol::Invalid(*reported);
                    self.symbols.scopes.declare(scope, &name, symbol);
                }
                Err(_) => self.incomplete(scope, *reported),
            }
        }
        if let Some(reported) = document.incomplete {
            self.incomplete(scope, reported);
            self.broken();
        }
        for (number, (name, _)) in document.values.iter().enumerate() {
            let value = DeclaredValue {
                scope,
                document: Arc::clone(document),
                number,
                state: ValueState::Declared,
            };
            let symbol = Symbol::Value(self.symbols.declare_value(value));
            self.symbols.scopes.declare(scope, &name.value, symbol);
        }
        for (number, material) in document.materials.iter().enumerate() {
            if self.symbols.resources.len() >= MOST {
                return self.is_full(&material.name().span, "materials");
            }
            let name = material.name();
            let mut at = self.symbols.at(scope.begin(), None);
            let picture = imports::replaced_picture(material, &at);
            let picture = picture.map(|input| imports::imported(&input, &mut at));
            let symbol = match picture.or_else(|| include::overridden(material, &mut at)) {
                Some(symbol) => symbol,
                None => {
                    let instance = self.symbols.scopes.instance_of(scope);
                    let full = self.symbols.scopes.full_name(instance, &name.value);
                    let declared = Declared {
                        scope,
                        document: Arc::clone(document),
                        number,
                    };
                    let id = self.symbols.declare(full, declared);
                    Symbol::Target(self.symbols.whole(id))
                }
            };
            self.symbols.scopes.declare(scope, &name.value, symbol);
        }
        self.needs(document, scope);
        let at = self.symbols.at(scope.begin(), None);
        self.waiting.add(document, scope, &at);
        self.replace_modules(None);
        self.entries(&document.entries, context);
        self.replace_modules(Some(scope));
    }

    /// Reports the conditions that a document needs and that do not hold.
    fn needs(&mut self, document: &Document, scope: ScopeId) {
        for need in &document.needs {
            let mut at = self.symbols.at(scope.begin(), None);
            // One without a value was reported.
            if self.plan_inputs.is_there(Some(need), &mut at) == Ok(false) {
                let evaluated = need.canonical(&mut |leaf| {
                    eval::value(leaf, &mut at).map_or_else(|_| "…".into(), |it| it.to_string())
                });
                self.symbols.reports.report(InterfaceError::Need {
                    document: document.file.name.to_string(),
                    need: Located::new(need.text().to_owned(), need.span.clone()),
                    evaluated,
                });
            }
        }
    }

    /// Has the modules take effect that stand in for others in shaders of documents: those whose
    /// conditions have their values, and at the `end` of a document all of its own.
    fn replace_modules(&mut self, end: Option<ScopeId>) {
        for (scope, entry) in self.waiting.ready(end, &self.symbols) {
            let mut at = self.symbols.at(scope.begin(), None);
            // A condition without a value was reported.
            if self.plan_inputs.is_there(entry.condition.as_ref(), &mut at) == Ok(true) {
                let instance = self.symbols.scopes.instance_of(scope);
                let replaced = &mut self.symbols.scopes.instance_mut(instance).replaced;
                let shaders = &self.symbols.graph.shaders;
                shaders.replace(replaced, &entry.of, &entry.is);
            }
        }
    }

    fn incomplete(&mut self, scope: ScopeId, reported: ErrorGuaranteed) {
        let instance = self.symbols.scopes.instance_of(scope);
        self.symbols.scopes.instance_mut(instance).incomplete = Some(reported);
    }

    pub(super) fn entries(
        &mut self,
        entries: &'a [Result<Entry, Invalid>],
        context: &EntryContext<'a>,
    ) {
        for entry in entries {
            match entry {
                Ok(entry) => {
                    if self.entry(entry, context).is_err() {
                        self.broken();
                    }
                }
                Err(broken) => {
                    self.broken();
                    if broken.is_include {
                        self.incomplete(context.scope, broken.reported);
                    }
                }
            }
        }
    }

    pub fn broken(&mut self) {
        let above = self.passes.len();
        self.first_invalid.get_or_insert(above);
    }

    fn entry(&mut self, entry: &'a Entry, context: &EntryContext<'a>) -> Reported<()> {
        if let Some(reported) = self.full {
            return Err(reported);
        }
        let scope = context.scope;
        let mut at = self.symbols.at(scope.begin(), None);
        let condition = entry.condition.as_ref();
        if !self.plan_inputs.is_there(condition, &mut at)? {
            return Ok(());
        }
        let count = match &entry.repeat {
            None => 1,
            Some(repeat) => eval::count32(repeat, &mut at)?,
        };
        self.spent = self.spent.saturating_add(count as usize);
        if self.spent > MOST {
            self.is_full(&entry.name.span, "passes");
        }
        if let Some(reported) = self.full {
            return Err(reported);
        }
        let Some(_) = entry.repeat else {
            return self.instance(entry, None, context).map(drop);
        };
        // Behind a mistake the others would be wrong in the same way.
        let given = (0..count).map(|index| self.instance(entry, Some(index), context));
        let given: Reported<Vec<Names>> = given.collect();
        let wrong = given.as_ref().err().copied();
        if !matches!(entry.what, What::Pass(_)) {
            let symbol = given.map_or_else(Symbol::Invalid, Symbol::Repeated);
            let scopes = &mut self.symbols.scopes;
            scopes.declare(scope, &entry.name.value, symbol);
        }
        wrong.map_or(Ok(()), Err)
    }

    /// Notes the params that decide the form of a pass, such as its engine.
    fn note_choices(&mut self, pass: &Pass, scope: ScopeId) {
        let roots = pass.mentions.exprs.iter();
        let roots = roots.flat_map(|expr| self.symbols.roots(scope, expr));
        let roots: BTreeSet<String> = roots.collect();
        let params = self.symbols.graph.document.params.iter();
        let choices = params
            .filter(|param| matches!(param.ty, ParamType::Choice(_) | ParamType::Bool))
            .map(|param| &param.name.value)
            .filter(|name| roots.contains(*name));
        self.plan_inputs.params.extend(choices.cloned());
    }

    /// Adds one repetition of an entry. Returns the names that it gives if the entry is repeated.
    fn instance(
        &mut self,
        entry: &'a Entry,
        index: Option<u32>,
        context: &EntryContext<'a>,
    ) -> Reported<Names> {
        let suffix = index.map_or(String::new(), |index| format!("[{index}]"));
        let name = format!("{}{}{suffix}", context.prefix, entry.name.value);
        let position = Position {
            scope: context.scope,
            index,
        };
        let mut at = self.symbols.at(position, None);
        let run = runs(entry, context.run.as_ref(), &mut self.period, &mut at)?;
        match &entry.what {
            What::Pass(pass) => {
                self.note_choices(pass, context.scope);
                let (run, turns) = run.unwrap_or((Run::Always, vec![true]));
                let pass = FlatPass {
                    name: Located::new(name, entry.name.span.clone()),
                    entry,
                    pass,
                    position,
                    run,
                    turns,
                    round: context.round,
                    inherited: self.asked(entry, pass, context),
                };
                self.mark(&pass.inherited);
                self.passes.push(pass);
                Ok(Names::new())
            }
            What::Group(entries) => {
                let scope = match index {
                    None => context.scope,
                    Some(index) => {
                        let scopes = &mut self.symbols.scopes;
                        let path = format!(
                            "{}{}[{index}].",
                            scopes.path(position.scope),
                            entry.name.value
                        );
                        let instance = scopes.instance_of(position.scope);
                        let index = Some((entry.name.value.clone(), index));
                        scopes.add_scope(instance, Some(position.scope), path, index)
                    }
                };
                let position = Position { scope, index: None };
                let round = self.round(entry, &name, position, context)?;
                let inner = EntryContext {
                    scope,
                    prefix: format!("{name}."),
                    run,
                    round,
                    settings: self.say(entry, position, &context.settings),
                };
                self.entries(entries, &inner);
                Ok(match index {
                    Some(_) => self.symbols.scopes.names(scope).clone(),
                    None => Names::new(),
                })
            }
            What::Include(include) => {
                let context = EntryContext {
                    prefix: format!("{name}."),
                    run,
                    ..context.clone()
                };
                self.include(entry, include, position, &context)
            }
        }
    }

    /// Returns the round that the entries of a group belong to, of this group or one around it.
    fn round(
        &mut self,
        group: &'a Entry,
        name: &str,
        position: Position,
        context: &EntryContext<'a>,
    ) -> Reported<Option<Round<'a>>> {
        let Some(counter) = &group.rounds else {
            return Ok(context.round);
        };
        if let Some(outer) = &context.round {
            let counters = [counter, outer.counter].map(Reference::located);
            let error = InterfaceError::RoundsInRounds(counters);
            return Err(self.symbols.reports.report(error));
        }
        // A slash stands in no name: nothing in a document can mean this buffer.
        let goes = Resource::new(
            format!("{name}/goes"),
            ResourceKind::buffer_of(1),
            Origin::Own,
        );
        Ok(Some(Round {
            counter,
            position,
            goes: self.symbols.add(goes),
        }))
    }

    /// Adds one repetition of an include and returns the names that it gives. If the include has no
    /// name and is not repeated, these names are declared in the document around it.
    fn include(
        &mut self,
        entry: &'a Entry,
        include: &'a Include,
        position: Position,
        context: &EntryContext<'a>,
    ) -> Reported<Names> {
        let document = match &include.document {
            Some(Ok(document)) => document,
            Some(Err(reported)) => {
                self.incomplete(position.scope, *reported);
                return Err(*reported);
            }
            None => return Ok(Names::new()),
        };
        self.require(document);
        let mut at = self.symbols.at(position, None);
        let of_groups = include::said(document, &context.settings, &mut at);
        let call = Call::new(entry, include, document, &of_groups, position);
        let params = call.params(&mut at);
        let (scene, overrides) = call.outside(&mut at);
        let given = |input| call.input(input, &mut at);
        let inputs: Vec<_> = document.inputs.iter().map(given).collect();
        self.mark(&call.settings);
        let around = self.symbols.scopes.instance_of(position.scope);
        let replaced = self.symbols.scopes.instance(around).replaced.clone();
        // With a name, or in a repetition, an include is one of its own; so is one that writes into
        // what it is given.
        let mut given = document.inputs.iter();
        let may_merge = self.merges
            && !call.has_namespace
            && overrides.is_empty()
            && self.symbols.scopes.index(position, None).is_none()
            && !given.any(|input| include::is_output(document, input));
        let content = may_merge.then(|| {
            let mut bound = self.symbols.scopes.bound_scene(around);
            bound.extend(scene.clone());
            let run = context.run.clone();
            let shaders = &self.symbols.graph.shaders;
            let asks = self.asks.entry(Arc::as_ptr(document));
            let asks = asks.or_insert_with(|| Asks::new(document, shaders));
            Content::new((document, asks), &params, &inputs, bound, &replaced, run)
        });
        let content = content.flatten();
        let mut sites = self.sites.iter();
        let site = sites.find(|site| Some(&site.content) == content.as_ref());
        let scopes = &mut self.symbols.scopes;
        if let Some(site) = site {
            self.merged.push(site.merge(self.passes.len(), include));
            let names = site.names.clone();
            call.give(&names, scopes)?;
            self.replace_modules(None);
            return Ok(names);
        }
        let first_resource = self.symbols.resources.len();
        let outer = call.outer(context);
        let instance = scopes.add_instance(Instance {
            document: Arc::clone(document),
            params: Arc::new(params),
            scene,
            outer: Some(outer),
            overrides,
            replaced,
            incomplete: None,
        });
        let scope = scopes.add_scope(instance, None, String::new(), None);
        let read_only = call.declare_inputs(scope, inputs, scopes);
        let inner = context.inside(scope);
        self.document(document, &inner);
        let mut at = self.symbols.at(scope.begin(), None);
        let plan_inputs = &mut self.plan_inputs;
        let (names, outputs) = call.outputs(plan_inputs, &mut at);
        self.interfaces.push(Interface {
            instance,
            outputs,
            read_only,
        });
        if let Some(content) = content {
            self.sites.push(Site {
                content,
                names: names.clone(),
                end: self.passes.len(),
                owned: first_resource..self.symbols.resources.len(),
            });
        }
        call.give(&names, &mut self.symbols.scopes)?;
        self.replace_modules(None);
        Ok(names)
    }

    /// Adds the settings of a group to those of the groups around it; the inner setting of a name
    /// replaces the outer one.
    fn say(&mut self, group: &'a Entry, position: Position, outer: &Settings<'a>) -> Settings<'a> {
        let own = Settings::own(group, position);
        for name in own.names() {
            let setting = self.said.entry(std::ptr::from_ref(name));
            setting.or_insert((&group.name, name, false));
        }
        own.within(outer)
    }

    /// Notes that an entry uses these settings of groups, so that they are not reported as unused.
    fn mark(&mut self, settings: &Settings<'_>) {
        for name in settings.names() {
            if let Some((.., is_asked)) = self.said.get_mut(&std::ptr::from_ref(name)) {
                *is_asked = true;
            }
        }
    }

    /// Returns the settings of groups around a pass that its shaders ask for, and that it does not
    /// make itself.
    fn asked(&self, entry: &Entry, pass: &Pass, context: &EntryContext<'a>) -> Settings<'a> {
        let instance = self.symbols.scopes.document(context.scope);
        let (document, replaced) = (&instance.document, &instance.replaced);
        let store = &self.symbols.graph.shaders;
        let shaders = pass.shaders.iter();
        let shaders = shaders.filter_map(|shader| store.get(document, shader, replaced));
        let shaders: Vec<_> = shaders.collect();
        // One with a mistake may ask for anything.
        let any = |asks: &dyn Fn(&Shader) -> bool| {
            let mut shaders = shaders.iter();
            shaders.any(|shader| shader.as_ref().map_or(true, |shader| asks(shader)))
        };
        let mut settings = context.settings.clone();
        settings.bind.retain(|it| {
            let is_bound = entry.bind.iter().any(|(own, _)| **own == **it.name);
            !is_bound && any(&|shader| shader.global_names().any(|name| *name == **it.name))
        });
        settings.set.retain(|it| {
            let is_set = entry.set.iter().any(|(own, _)| **own == **it.name);
            !is_set && any(&|shader| shader.params().any(|name| *name == **it.name))
        });
        settings
    }

    /// Reports once that the graph has too many passes or materials.
    fn is_full(&mut self, at: &Span, what: &'static str) {
        self.broken();
        if self.full.is_none() {
            let error = InterfaceError::TooMany(MOST, what, at.clone());
            self.full = Some(self.symbols.reports.report(error));
        }
    }

    /// Finds the sizes of all resources, and returns the flat graph.
    fn finish(mut self) -> (Flat<'a>, Vec<FlatPass<'a>>) {
        let mut number = 0;
        // Finding one may add others.
        while number < self.symbols.resources.len() {
            let id = ResourceId(number);
            // A broken one is stored as such, and its users find that.
            let _ = self.symbols.resolve_size(id);
            number += 1;
        }
        for (group, name, is_asked) in std::mem::take(&mut self.said).into_values() {
            if !is_asked && self.first_invalid.is_none() {
                let group = group.value.to_string();
                let error = InterfaceError::UnusedInGroup(group, name.clone());
                self.symbols.reports.report(error);
            }
        }
        let flat = Flat {
            symbols: self.symbols,
            first_invalid: self.first_invalid,
            interfaces: self.interfaces,
            merged: self.merged,
            plan_inputs: self.plan_inputs,
        };
        (flat, self.passes)
    }

    /// Notes the inputs and outputs of the root document.
    fn root_interface(&mut self, document: &Document, instance: InstanceId, scope: ScopeId) {
        let mut read_only = Vec::new();
        for input in &document.inputs {
            let symbol = self.symbols.scopes.find(scope, &input.name.value);
            if let Some(Symbol::Target(target)) = symbol
                && !include::is_output(document, input)
            {
                read_only.push((input.name.clone(), target.clone()));
            }
        }
        self.interfaces.push(Interface {
            instance,
            outputs: Vec::new(),
            read_only,
        });
    }
}
