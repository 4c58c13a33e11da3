//! Flattens documents: walks their entries and resolves conditions, repetitions, groups and
//! includes.

use super::{
    flat::{EntryContext, Flat, FlatPass, Inherited, Interface, Merge, PlanInputs, Round, Run},
    include::{self, Call},
    merge::{Asks, Content, Site},
    modules::WaitingModules,
    params::Params,
    scopes::{Instance, InstanceId, Names, Position, ScopeId, Symbol},
    state::{Declared, DeclaredValue, ValueState},
    symbols::SymbolTable,
};
use crate::{
    compose::loaded::Loaded,
    diagnostics::reports::{ErrorGuaranteed, Reported, Reports},
    document::{
        materials::{FormatEntry, Input, InputKind, Material},
        raw::Invalid,
        typed::{Document, Entry, Include, Pass, Run as RunEntry, What},
    },
    errors::{evaluation::EvaluationError, instantiate::InterfaceError},
    expressions::eval,
    language::{
        name::Name,
        syntax::{Expr, Reference},
        value::least_common_multiple,
    },
    param::ParamType,
    provider::Import,
    request::PlanRequest,
    resource::{Buffer, Origin, Resource, ResourceId, ResourceKind, Sampler, Texture},
    shader::expand::Replaced,
    source::span::{Located, Span},
};
use std::{
    collections::{BTreeMap, BTreeSet, HashMap},
    sync::Arc,
};

/// Greatest number of passes (groups and includes among them), and of materials, of a graph. It
/// guards against documents that double with each include, which would take absurd time and memory.
const MOST: usize = 16_384;

/// Greatest number of frames after which the run conditions of a graph repeat: a method is
/// judged over all of them.
const LONGEST_PERIOD: u64 = 64;

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
    /// Settings of groups: name of the group, name of the setting, and true if an entry in the
    /// group uses it.
    said: Vec<(&'a Located<Name>, &'a Located<String>, bool)>,
    spent: usize,
    full: Option<ErrorGuaranteed>,
    /// Number of frames after which all run conditions so far repeat.
    period: u64,
}

/// Flattens a document with all that it includes. `merges`: includes of the same content are
/// merged.
pub(crate) fn flatten<'a>(
    graph: &'a Loaded,
    request: &'a PlanRequest<'a>,
    params: Params,
    merges: bool,
    reports: Reports,
) -> Flat<'a> {
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
        said: Vec::new(),
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
            let symbol = self.imported(input);
            let scopes = &mut self.symbols.scopes;
            scopes.declare(scope, &input.name.value, symbol);
        }
    }

    fn imported(&mut self, input: &Input) -> Symbol {
        let name = &input.name;
        match self.import(input) {
            Ok(kind) => {
                let id = self.symbols.add(Resource {
                    declared: Some(name.span.clone()),
                    ..Resource::new(name.value.to_string(), kind, Origin::Host)
                });
                Symbol::Target(self.symbols.whole(id))
            }
            Err(error) => Symbol::Invalid(self.symbols.reports.report(error)),
        }
    }

    /// Returns the input in the place of a texture whose picture the host replaces.
    fn replaced_picture(&self, material: &Material, instance: InstanceId) -> Option<Input> {
        let Material::Texture(texture) = material else {
            return None;
        };
        let is_root = self.symbols.scopes.instance(instance).outer.is_none();
        let name = &texture.name;
        let is_replaced = self.symbols.request.imports.contains_key(name.as_str());
        (is_root && is_replaced && texture.file.is_some()).then(|| Input {
            name: name.clone(),
            kind: InputKind::Texture(match texture.format {
                FormatEntry::Named(format) => Some(format),
                FormatEntry::Expr(_) => None,
            }),
        })
    }

    fn import(&self, input: &Input) -> Result<ResourceKind, InterfaceError> {
        let name = input.name.text();
        let Some(import) = self.symbols.request.imports.get(&name.value) else {
            return Err(InterfaceError::NoImport(name));
        };
        let kind = imported(*import);
        if include::takes(&input.kind, &kind) {
            return Ok(kind);
        }
        let (expected, imported) = match (&input.kind, &kind) {
            (InputKind::Texture(Some(asked)), ResourceKind::Texture(texture)) => (
                format!("a texture {asked:?}"),
                format!("a texture {:?}", texture.format),
            ),
            (asked, given) => (asked.describe().to_owned(), given.describe().to_owned()),
        };
        Err(InterfaceError::WrongImport {
            name,
            expected,
            imported,
        })
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
            let instance = self.symbols.scopes.instance_of(scope);
            if let Some(input) = self.replaced_picture(material, instance) {
                let symbol = self.imported(&input);
                self.symbols.scopes.declare(scope, &name.value, symbol);
                continue;
            }
            let mut at = self.symbols.at(scope.begin(), None);
            let symbol = match include::overridden(material, &mut at) {
                Some(Ok(target)) => Symbol::Target(target),
                Some(Err(reported)) => Symbol::Invalid(reported),
                None => {
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
        let run = self.run(entry, position, context)?;
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
                    bind: self.asked(&context.bind, |name| {
                        self.asks_global(context.scope, entry, name)
                    }),
                    set: self.asked(&context.set, |name| {
                        self.asks_param(context.scope, entry, name)
                    }),
                };
                self.mark(&pass.bind, &pass.set);
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
                    bind: self.say(&entry.bind, position, entry, &context.bind),
                    set: self.say(&entry.set, position, entry, &context.set),
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
        let kind = ResourceKind::Buffer(Buffer {
            count: Some(1),
            ..Buffer::default()
        });
        // A slash stands in no name: nothing in a document can mean this buffer.
        let goes = Resource::new(format!("{name}/goes"), kind, Origin::Own);
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
        let of_groups = include::said(entry, document, context, &mut at);
        let call = Call::new(entry, include, document, &of_groups, position);
        let params = call.params(&mut at);
        let (scene, overrides) = call.outside(&mut at);
        let given = |input| call.input(input, &mut at);
        let inputs: Vec<_> = document.inputs.iter().map(given).collect();
        self.mark(&of_groups.0, &of_groups.1);
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

    /// Returns the frames in which an entry runs, which entries inside inherit.
    fn run(
        &mut self,
        entry: &Entry,
        position: Position,
        context: &EntryContext<'a>,
    ) -> Reported<Option<(Run, Vec<bool>)>> {
        let always = |run| Ok(Some((run, vec![true])));
        let condition = match &entry.run {
            None => return Ok(context.run.clone()),
            Some(RunEntry::Always) => return always(Run::Always),
            Some(RunEntry::Once) => return always(Run::Once),
            Some(RunEntry::OnChange) => return always(Run::OnChange),
            Some(RunEntry::When(condition)) => condition,
        };
        let turns = self.turns(condition, position)?;
        let instance = self.symbols.scopes.document(position.scope);
        let params = Arc::clone(&instance.params);
        let outer = instance.outer.as_ref();
        let private = outer.map_or(String::new(), |outer| outer.private.clone());
        // Conditions of two documents are one if they are made of the same params of the root;
        // attributes (`index` is one) are what they are here.
        let text = condition.canonical(&mut |leaf| {
            if leaf.is_frame_number() && turns.len() > 1 {
                return leaf.text().to_owned();
            }
            if let Some(name) = leaf.as_param() {
                let is_param = |name: &str| params.bound(name).is_some();
                let part = leaf.as_component().filter(|(owner, _)| is_param(owner));
                let (name, part) = match part.filter(|_| !is_param(name)) {
                    Some((owner, part)) => (owner, format!(".{}", part.as_str())),
                    None => (name, String::new()),
                };
                match params.bound(name).map(|bound| &bound.root) {
                    Some(Some(root)) => return format!("{root}{part}"),
                    Some(None) => return format!("{private}{name}{part}"),
                    None => {}
                }
                let scopes = &self.symbols.scopes;
                let owner = leaf.as_component().map_or(name, |(owner, _)| owner);
                if [name, owner]
                    .iter()
                    .all(|it| scopes.find_value(position.scope, it).is_none())
                {
                    return name.to_owned();
                }
            }
            let value = eval::value(leaf, &mut self.symbols.at(position, None));
            value.map_or_else(|_| leaf.text().to_owned(), |value| value.to_string())
        });
        Ok(Some((Run::When(text), turns)))
    }

    /// Returns the values of a run condition, frame by frame until they repeat.
    fn turns(&mut self, condition: &Expr, position: Position) -> Reported<Vec<bool>> {
        let mut turns = Vec::new();
        let mut at = self.symbols.at(position, None);
        let (mut frame, mut repeats) = (0, 1);
        while frame < repeats {
            at.frame = Some((frame, repeats));
            turns.push(eval::boolean(condition, &mut at)?);
            (frame, repeats) = (frame + 1, at.frame.map_or(repeats, |(_, repeats)| repeats));
            let period = least_common_multiple(self.period, repeats);
            if period > LONGEST_PERIOD {
                return Err(at.report(EvaluationError::FramePeriod {
                    place: condition.span.clone(),
                    period,
                    most: LONGEST_PERIOD,
                }));
            }
        }
        self.period = least_common_multiple(self.period, repeats);
        Ok(turns)
    }

    /// Adds the settings of a group to those of the groups around it; the inner setting of a name
    /// replaces the outer one.
    fn say<T>(
        &mut self,
        own: &'a [(Located<String>, T)],
        position: Position,
        group: &'a Entry,
        outer: &[Inherited<'a, T>],
    ) -> Vec<Inherited<'a, T>> {
        let mut inherited = Vec::new();
        for (name, value) in own {
            let mut settings = self.said.iter();
            let index = settings.position(|(_, other, _)| std::ptr::eq(*other, name));
            let number = index.unwrap_or_else(|| {
                self.said.push((&group.name, name, false));
                self.said.len() - 1
            });
            inherited.push(Inherited {
                name,
                value,
                position,
                number,
            });
        }
        let hidden = |name: &str| own.iter().any(|(own, _)| **own == *name);
        let outer = outer.iter().copied();
        inherited.extend(outer.filter(|setting| !hidden(setting.name)));
        inherited
    }

    /// Returns the bindings or values of groups in `inherited` for the names that `asks` accepts.
    pub fn asked<T>(
        &self,
        inherited: &[Inherited<'a, T>],
        asks: impl Fn(&str) -> bool,
    ) -> Vec<Inherited<'a, T>> {
        let asked = inherited.iter().filter(|setting| asks(setting.name));
        asked.copied().collect()
    }

    /// Notes that an entry uses these bindings and values of groups, so that they are not reported
    /// as unused.
    pub fn mark<T, U>(&mut self, bind: &[Inherited<'_, T>], set: &[Inherited<'_, U>]) {
        let numbers = bind.iter().map(|setting| setting.number);
        for number in numbers.chain(set.iter().map(|setting| setting.number)) {
            self.said[number].2 = true;
        }
    }

    /// True if a shader of a pass has this global and the pass itself does not bind it.
    fn asks_global(&self, scope: ScopeId, entry: &Entry, name: &str) -> bool {
        let is_bound = entry.bind.iter().any(|(own, _)| **own == *name);
        !is_bound
            && self.any_shader(scope, entry, |shader| {
                shader.global_names().any(|n| n == name)
            })
    }

    /// True if a shader of a pass has this param or override and the pass itself does not set it.
    fn asks_param(&self, scope: ScopeId, entry: &Entry, name: &str) -> bool {
        let is_set = entry.set.iter().any(|(own, _)| **own == *name);
        !is_set && self.any_shader(scope, entry, |shader| shader.params().any(|n| n == name))
    }

    fn any_shader(
        &self,
        scope: ScopeId,
        entry: &Entry,
        asks: impl Fn(&crate::shader::reflect::Shader) -> bool,
    ) -> bool {
        let What::Pass(pass) = &entry.what else {
            return false;
        };
        let instance = self.symbols.scopes.document(scope);
        let (document, replaced) = (&instance.document, &instance.replaced);
        let store = &self.symbols.graph.shaders;
        let shaders = pass.shaders.iter();
        let mut shaders = shaders.filter_map(|shader| store.get(document, shader, replaced));
        // One with a mistake may ask for anything.
        shaders.any(|shader| shader.as_ref().map_or(true, |shader| asks(shader)))
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
    fn finish(mut self) -> Flat<'a> {
        let mut number = 0;
        // Finding one may add others.
        while number < self.symbols.resources.len() {
            let id = ResourceId(number);
            // A broken one is stored as such, and its users find that.
            let _ = self.symbols.resolve_size(id);
            number += 1;
        }
        for (group, name, is_asked) in std::mem::take(&mut self.said) {
            if !is_asked && self.first_invalid.is_none() {
                let group = group.value.to_string();
                let error = InterfaceError::UnusedInGroup(group, name.clone());
                self.symbols.reports.report(error);
            }
        }
        Flat {
            symbols: self.symbols,
            passes: self.passes,
            first_invalid: self.first_invalid,
            interfaces: self.interfaces,
            merged: self.merged,
            plan_inputs: self.plan_inputs,
        }
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

/// Returns the resource kind for an import.
fn imported(import: Import) -> ResourceKind {
    match import {
        Import::Texture {
            format,
            size,
            mips,
            layers,
            is_3d,
            samples,
            ..
        } => ResourceKind::Texture(Texture {
            format,
            size,
            layers,
            is_3d,
            mips,
            samples,
            picture: None,
        }),
        Import::Buffer { bytes, items, .. } => ResourceKind::Buffer(Buffer {
            count: items,
            bytes,
            ..Buffer::default()
        }),
        Import::Sampler { filter, compare } => ResourceKind::Sampler(Sampler {
            filter,
            address: Default::default(),
            compare: compare.then_some(wgt::CompareFunction::LessEqual),
        }),
    }
}
