//! Resources and values of a plan, and the resolution of references to them.

use super::growth::Sizing;
use super::materials;
use super::scopes::{Instance, Position, ScopeId, Scopes, ValueId};
use super::state::{Declared, DeclaredValue, State, ValueState};
use crate::compose::Loaded;
use crate::diagnostics::{Diagnostic, ErrorGuaranteed, Reported, Reports};
use crate::errors::evaluation::EvaluationError;
use crate::expressions::{eval, parser};
use crate::language::{Expr, Leaf, Reference, Value, wgsl_identifier};
use crate::provided_kind::ProvidedKind;
use crate::provider::{Provided, ProvidedBinding};
use crate::request::PlanRequest;
use crate::resource::{
    FRAME, Origin, Resource, ResourceId, ResourceKind, SubresourceRange, Target,
};
use crate::shader::Shader;
use crate::source::{Located, SourceFile, Span};
use std::cell::RefCell;
use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::sync::Arc;

/// Greatest length of a chain of values that use each other; far above any sensible one, far below
/// the limit of the stack.
const DEEPEST_VALUE: usize = 64;

/// Greatest depth of sizes that are found while another size is being found.
const NESTED: usize = 8;

/// Meanings of all names in the documents of a graph for one plan: its scopes, resources and named
/// values.
pub(crate) struct SymbolTable<'a> {
    /// Loaded documents and shaders of the graph.
    pub graph: &'a Loaded,
    /// Request that the plan is made for.
    pub request: &'a PlanRequest<'a>,
    /// Mistakes reported so far; any look-up of a name or size may add one.
    pub reports: Reports,
    /// Scopes of names, and the instances of documents that they belong to.
    pub scopes: Scopes,
    /// Resources found so far; a [`ResourceId`] is an index into this list.
    pub resources: Vec<Resource>,
    /// State of each resource's size, by index of the resource.
    pub(super) states: Vec<State>,
    /// Materials whose sizes are being found; the size of each is needed for the one before it.
    pub(super) evaluating: Vec<ResourceId>,
    /// Values, and those of them that are being found, each for the sake of the one before.
    values: Vec<DeclaredValue>,
    resolving: Vec<ValueId>,
    /// Resources for the names of the scene that were used so far.
    scene: HashMap<String, ResourceId>,
    /// Names of the scene by their spelling in shaders.
    wgsl_name: HashMap<String, String>,
    /// Last frame's version of each resource that has one.
    previous: BTreeMap<ResourceId, ResourceId>,
    /// Descriptions of the provider's resources whose number of items, kind or presence was asked
    /// for; `None` where the provider knows no such resource.
    asked: RefCell<BTreeMap<String, Option<Provided>>>,
}

impl<'a> SymbolTable<'a> {
    pub fn new(graph: &'a Loaded, request: &'a PlanRequest<'a>, reports: Reports) -> Self {
        let names = request.provider.names().into_iter();
        let names = names.chain([FRAME.to_owned()]);
        Self {
            graph,
            request,
            reports,
            scopes: Scopes::default(),
            resources: Vec::new(),
            states: Vec::new(),
            evaluating: Vec::new(),
            values: Vec::new(),
            resolving: Vec::new(),
            scene: HashMap::new(),
            wgsl_name: names.map(|name| (wgsl_identifier(&name), name)).collect(),
            previous: BTreeMap::new(),
            asked: RefCell::default(),
        }
    }

    /// Takes the descriptions of the provider's resources whose number of items, kind or presence
    /// was asked for; `None` where the provider knows no such resource.
    pub fn take_asked(&mut self) -> BTreeMap<String, Option<Provided>> {
        self.asked.take()
    }

    /// Names and kinds of the provided resources that are bound, or whose kind was asked for.
    pub fn kinds(&self) -> Vec<(String, ProvidedKind)> {
        let bound = self.resources.iter().filter_map(Resource::named_kind);
        let bound = bound.map(|(name, kind)| (name.to_owned(), kind));
        let asked = self.asked.borrow();
        let asked = asked.iter();
        let asked = asked.filter_map(|(name, provided)| Some((name.clone(), (*provided)?.kind?)));
        bound.chain(asked).collect()
    }

    /// Asks the provider for a description, and notes the answer.
    pub(super) fn ask(&self, name: &str) -> Option<Provided> {
        let described = self.request.provider.describe(name);
        self.asked.borrow_mut().insert(name.to_owned(), described);
        described
    }

    /// Notes the description of a resource, or of the one that it is the last frame's copy of.
    pub(super) fn note_asked(&self, resource: &Resource, provided: Provided) {
        let name = match resource.origin {
            Origin::Previous(base) => &self.get(base).name,
            _ => &resource.name,
        };
        let mut asked = self.asked.borrow_mut();
        asked.insert(name.clone(), Some(provided));
    }

    /// Returns an environment for expressions at a position in a document. `shader` is the shader
    /// whose constants the expressions can use, for those of a pass; `None` for others.
    pub fn at<'w>(
        &'w mut self,
        position: Position,
        shader: Option<Reported<Arc<Shader>>>,
    ) -> At<'w, 'a> {
        At {
            symbols: self,
            position,
            shader,
            frame: None,
        }
    }

    pub fn get(&self, id: ResourceId) -> &Resource {
        &self.resources[id.0]
    }

    /// Adds a resource whose size is known, and returns its id.
    pub fn add(&mut self, resource: Resource) -> ResourceId {
        self.resources.push(resource);
        self.states.push(State::Known);
        ResourceId(self.resources.len() - 1)
    }

    /// Adds a material whose size is found when it is first asked for.
    pub(super) fn declare(&mut self, name: String, declared: Declared) -> ResourceId {
        let kind = ResourceKind::Buffer(crate::resource::Buffer::default());
        let id = self.add(Resource {
            declared: Some(declared.material().name().span.clone()),
            keep: declared.material().keeps(),
            ..Resource::new(name, kind, Origin::Own)
        });
        self.states[id.0] = State::Declared(declared);
        id
    }

    /// Adds a value, which is evaluated when an expression or a shader first asks for it.
    pub(super) fn declare_value(&mut self, value: DeclaredValue) -> ValueId {
        self.values.push(value);
        ValueId(self.values.len() - 1)
    }

    /// Returns the result of a named value. It is evaluated the first time that it is asked for.
    pub fn value(&mut self, id: ValueId) -> Reported<Value> {
        let declared = &mut self.values[id.0];
        match &declared.state {
            ValueState::Known(value) => return value.clone(),
            ValueState::Resolving => return Err(self.circular_value(id)),
            ValueState::Declared => {}
        }
        if self.resolving.len() == DEEPEST_VALUE {
            let name = declared.name().text();
            let error = EvaluationError::DeepValue(name, DEEPEST_VALUE);
            return Err(self.reports.report(error));
        }
        declared.state = ValueState::Resolving;
        let position = declared.scope.begin();
        let expr = declared.expr().clone();
        self.resolving.push(id);
        let value = eval::value(&expr, &mut self.at(position, None));
        self.resolving.pop();
        self.values[id.0].state = ValueState::Known(value.clone());
        value
    }

    /// Returns the named values that were evaluated without a mistake, in the order of their
    /// declaration: pairs of full name and result as text.
    pub fn found_values(&self) -> Vec<(String, String)> {
        let values = self.values.iter().filter_map(|declared| {
            let ValueState::Known(Ok(value)) = &declared.state else {
                return None;
            };
            let instance = self.scopes.instance_of(declared.scope);
            let name = self.scopes.full_name(instance, &declared.name().value);
            Some((name, value.to_string()))
        });
        values.collect()
    }

    fn circular_value(&mut self, id: ValueId) -> ErrorGuaranteed {
        let ring = self.resolving.iter().skip_while(|other| **other != id);
        let ring = ring.chain([&id]);
        let ring = ring.map(|id| self.values[id.0].name().text());
        let error = EvaluationError::CircularValue(ring.collect());
        self.reports.report(error)
    }

    /// Returns the place of a value's expression, for messages.
    pub fn value_span(&self, id: ValueId) -> &Span {
        &self.values[id.0].expr().span
    }

    /// Calls `each` with every leaf of an expression and the scope in which it stands. Values are
    /// replaced by the leaves of their expressions.
    pub fn visit<'e>(
        &'e self,
        scope: ScopeId,
        expr: &'e Expr,
        each: &mut dyn FnMut(ScopeId, Leaf<'e>),
    ) {
        let mut seen = BTreeSet::new();
        let mut open = vec![(scope, expr)];
        while let Some((scope, expr)) = open.pop() {
            expr.visit(&mut |leaf| {
                let params = &self.scopes.document(scope).params;
                let name = leaf.named().filter(|name| params.bound(name).is_none());
                match name.and_then(|name| self.scopes.find_value(scope, name)) {
                    Some(id) if seen.insert(id) => {
                        let value = &self.values[id.0];
                        open.push((value.scope, value.expr()));
                    }
                    Some(_) => {}
                    None => each(scope, leaf),
                }
            });
        }
    }

    /// Returns the names of the loaded document's params on which an expression in a scope depends.
    pub fn roots(&self, scope: ScopeId, expr: &Expr) -> BTreeSet<String> {
        let mut roots = BTreeSet::new();
        self.visit(scope, expr, &mut |scope, leaf| {
            let params = &self.scopes.document(scope).params;
            let bound = leaf.named().and_then(|name| params.bound(name));
            roots.extend(bound.iter().flat_map(|bound| bound.roots.clone()));
        });
        roots
    }

    /// Marks a buffer as invalid whose number of items was asked for and is not known.
    pub(super) fn mark_invalid(&mut self, id: ResourceId, reported: ErrorGuaranteed) {
        if matches!(self.get(id).kind, ResourceKind::Buffer(_)) {
            self.states[id.0] = State::Invalid(reported);
        }
    }

    /// Returns a target that holds all of a resource.
    pub fn whole(&self, id: ResourceId) -> Target {
        let part = match &self.get(id).kind {
            ResourceKind::Texture(texture) => texture.whole(),
            _ => SubresourceRange::WHOLE,
        };
        Target { id, part }
    }

    /// Returns the resource, or part of it, that a reference at `position` in a document means.
    pub fn resolve(&mut self, reference: &Reference, position: Position) -> Reported<Target> {
        self.at(position, None).resolve(reference)
    }

    /// Returns the target for the name of a provided resource, such as `scene.indices`, in a scope:
    /// the material that an include binds to the name, or else the provided resource. `None` if the
    /// provider does not know the name.
    pub fn find_scene(&mut self, name: &str, scope: ScopeId) -> Option<Reported<Target>> {
        let instance = self.scopes.instance_of(scope);
        if let Some(bound) = self.scopes.scene(instance, name) {
            return Some(bound);
        }
        let id = match self.scene.get(name) {
            Some(id) => *id,
            None => {
                let kind = match self.request.provider.describe(name) {
                    Some(provided) => match provided.binding {
                        ProvidedBinding::AccelerationStructure => {
                            ResourceKind::AccelerationStructure
                        }
                        ProvidedBinding::CpuWork => ResourceKind::CpuWork,
                        _ => ResourceKind::Provided(provided),
                    },
                    None if name == FRAME => ResourceKind::Frame,
                    None => return None,
                };
                let id = self.add(Resource::new(name.to_owned(), kind, Origin::Host));
                self.scene.insert(name.to_owned(), id);
                id
            }
        };
        Some(Ok(self.whole(id)))
    }

    /// Returns the kind of the provided resource `name` in a scope. If an include binds a material
    /// to the name, returns the first kind. `None` for an unknown name, and for a resource without
    /// kinds.
    pub fn provided_kind(&mut self, name: &str, scope: ScopeId) -> Option<ProvidedKind> {
        let Some(target) = self.find_scene(name, scope) else {
            return self.ask(name)?.kind;
        };
        let target = target.ok()?;
        let resource = self.get(target.id);
        if let ResourceKind::Provided(provided) = &resource.kind {
            // An include may bind another one to the name.
            self.note_asked(resource, *provided);
            return provided.kind;
        }
        let kind = self.ask(name)?.kind?;
        Some(ProvidedKind { number: 0, ..kind })
    }

    /// Returns the kind for an overridable constant of a shader such as `light_kind`, which gets
    /// the number of the kind of `light`. `None` for other constants.
    pub fn kind_of_wgsl_name(&mut self, constant: &str, scope: ScopeId) -> Option<ProvidedKind> {
        let identifier = constant.strip_suffix("_kind")?;
        let name = self.wgsl_name.get(identifier).cloned();
        self.provided_kind(&name.unwrap_or(identifier.to_owned()), scope)
    }

    /// Returns the target for the shader global `global` in a scope: a material, a provided
    /// resource, or the previous version of one (`…_previous`). `None` for an unknown name.
    pub fn find_global(&mut self, global: &str, scope: ScopeId) -> Option<Reported<Target>> {
        let target = self.scopes.find_wgsl_name(scope, global).or_else(|| {
            let name = self.wgsl_name.get(global).cloned()?;
            self.find_scene(&name, scope)
        });
        if let Some(target) = target {
            return Some(target.and_then(|target| {
                self.resolve_size(target.id)?;
                Ok(if target.part == SubresourceRange::WHOLE {
                    self.whole(target.id)
                } else {
                    target
                })
            }));
        }
        let base = self.find_global(global.strip_suffix("_previous")?, scope)?;
        let previous = base.map(|base| {
            let id = self.previous(base.id).ok()?;
            Some(Target { id, ..base })
        });
        previous.transpose()
    }

    /// Returns the position of the root document's own expressions.
    pub fn root(&self) -> Position {
        self.scopes.root().begin()
    }

    /// Finds the output or capture that a request names: a resource by its full name, or a part of
    /// one that the root document knows. `None` if the name is unknown.
    pub fn find_full(&mut self, name: &str) -> Option<Reported<Target>> {
        let mut resources = self.resources.iter();
        let position = resources.position(|resource| resource.name == name);
        if let Some(number) = position {
            let id = ResourceId(number);
            return Some(self.resolve_size(id).map(|()| self.whole(id)));
        }
        // A file of its own, so that mistakes in it are told as those of a command.
        let file = SourceFile::new("command line", name);
        let reference = parser::reference(&file, 0..name.len()).ok()?;
        let heard = std::mem::take(&mut self.reports);
        let target = self.resolve(&reference, self.root());
        self.reports = heard;
        target.ok().map(Ok)
    }

    /// Returns the full names of all resources, sorted, then the names of provided resources that
    /// no pass uses.
    pub fn full_names(&self) -> Vec<String> {
        let mut names: Vec<String> = self.resources.iter().map(|r| r.name.clone()).collect();
        names.sort();
        let scene = self.request.provider.names().into_iter();
        names.extend(scene.filter(|name| !self.scene.contains_key(name)));
        names
    }

    /// Returns every name that can be used in a scope: first those of its document, then those of
    /// the provider.
    pub fn known(&self, scope: ScopeId) -> Vec<String> {
        let mut names = self.scopes.known(scope);
        names.extend(self.request.provider.names());
        names
    }

    /// Returns the name of a resource with `keep: true`; `None` for a resource without `keep`.
    pub fn kept(&self, id: ResourceId) -> Option<String> {
        let resource = self.get(id);
        resource.keep.then(|| resource.name.clone())
    }

    /// Returns last frame's version of a resource, added on first use. The error is a word for a
    /// resource that has no such version.
    pub(super) fn previous(&mut self, base: ResourceId) -> Result<ResourceId, String> {
        if let Some(id) = self.previous.get(&base) {
            return Ok(*id);
        }
        let resource = self.get(base);
        let what = match (&resource.kind, resource.origin) {
            _ if resource.keep => Some("kept".to_owned()),
            (ResourceKind::Texture(_) | ResourceKind::Buffer(_), Origin::Own) => None,
            (ResourceKind::Provided(_), _) => None,
            (_, Origin::Host) => Some("the host's".to_owned()),
            (_, Origin::Constant) => Some("constant".to_owned()),
            (_, Origin::Previous(_)) => Some("one already".to_owned()),
            (kind, _) => Some(kind.describe().to_owned()),
        };
        if let Some(what) = what {
            return Err(what);
        }
        let resource = Resource {
            name: format!("{}.previous", resource.name),
            origin: Origin::Previous(base),
            ..resource.clone()
        };
        let id = self.add(resource);
        self.previous.insert(base, id);
        Ok(id)
    }

    /// Returns the resource that has the layout and size of `id`: if `id` holds another resource's
    /// content of the frame before (`.previous`), that resource; otherwise `id` itself.
    pub fn base(&self, id: ResourceId) -> ResourceId {
        match self.get(id).origin {
            Origin::Previous(base) => base,
            _ => id,
        }
    }

    /// Copies the kind and size of each resource to the one that holds its content of the frame
    /// before (`.previous`).
    pub fn size_previous(&mut self) {
        for (base, previous) in &self.previous {
            self.resources[previous.0].kind = self.resources[base.0].kind.clone();
        }
    }

    /// Finds the size of a resource if it is not known yet. Materials that it is made of come
    /// first, so that no chain of sizes is as deep as the stack. The exception is a material in an
    /// expression that is itself made of the expression's material: it is found on the way.
    pub fn resolve_size(&mut self, id: ResourceId) -> Reported<()> {
        if matches!(self.states[id.0], State::Declared(_)) {
            match self.evaluating.len() {
                0 => self.resolve_sizes_of_parts(id),
                1..NESTED => self.evaluate(id),
                _ => return Err(self.circular(id)),
            }
        }
        match &self.states[id.0] {
            State::Known => Ok(()),
            State::Invalid(reported) => Err(*reported),
            State::Declared(_) | State::Resolving => Err(self.circular(id)),
        }
    }

    fn circular(&mut self, id: ResourceId) -> ErrorGuaranteed {
        // The walk began with the one that is evaluated last, which is the one that the first asks
        // for.
        let mut ring = self.evaluating.iter().skip_while(|other| **other != id);
        let resource = self.get(ring.nth(1).copied().unwrap_or(id));
        let span = resource.declared.clone();
        let span = span.unwrap_or_else(|| self.graph.place());
        let name = Located::new(resource.name.clone(), span);
        self.reports.report(EvaluationError::Circular(name))
    }

    fn resolve_sizes_of_parts(&mut self, id: ResourceId) {
        let mut seen = BTreeSet::from([id]);
        let mut open = vec![(id, self.parts(id))];
        while let Some((last, parts)) = open.last_mut() {
            match parts.pop() {
                Some(part) if seen.insert(part) => open.push((part, self.parts(part))),
                Some(_) => {}
                None => {
                    let last = *last;
                    open.pop();
                    self.evaluate(last);
                }
            }
        }
    }

    /// Returns the materials that the size of a material depends on, if their own sizes are not
    /// found yet.
    fn parts(&self, id: ResourceId) -> Vec<ResourceId> {
        let State::Declared(declared) = &self.states[id.0] else {
            return Vec::new();
        };
        let mut parts = declared.parts(&self.scopes);
        parts.retain(|part| matches!(self.states[part.index()], State::Declared(_)));
        parts
    }

    fn evaluate(&mut self, id: ResourceId) {
        let state = &mut self.states[id.0];
        let State::Declared(declared) = std::mem::replace(state, State::Resolving) else {
            return;
        };
        self.evaluating.push(id);
        let full_name = self.resources[id.0].name.clone();
        let (graph, request) = (self.graph, self.request);
        let position = declared.scope.begin();
        let mut at = self.at(position, None);
        let kind = materials::kind(&declared, &full_name, (graph, request), &mut at);
        self.evaluating.pop();
        self.states[id.0] = match kind {
            Ok((kind, growth)) => {
                let is_constant = match &kind {
                    ResourceKind::Texture(texture) => texture.picture.is_some(),
                    ResourceKind::Buffer(buffer) => buffer.data.is_some(),
                    _ => false,
                };
                if is_constant {
                    self.resources[id.0].origin = Origin::Constant;
                }
                self.resources[id.0].kind = kind;
                self.resources[id.0].growth = growth;
                State::Known
            }
            Err(reported) => State::Invalid(reported),
        };
    }
}

/// Environment that evaluates expressions and resolves references at a position of a document.
pub(crate) struct At<'w, 'a> {
    pub symbols: &'w mut SymbolTable<'a>,
    /// Position in a document at which the expressions and references stand.
    pub position: Position,
    /// Shader of the pass, for an expression of a pass.
    pub(super) shader: Option<Reported<Arc<Shader>>>,
    /// In a condition on frames, the number of the frame, and the number of frames after which the
    /// condition repeats; `None` elsewhere.
    pub(super) frame: Option<(u64, u64)>,
}

impl<'a> At<'_, 'a> {
    pub fn report(&mut self, mistake: impl Into<Diagnostic>) -> ErrorGuaranteed {
        self.symbols.reports.report(mistake)
    }

    /// Returns the use of a document that this position lies in.
    pub fn instance(&self) -> &Instance {
        self.symbols.scopes.document(self.position.scope)
    }

    /// Returns an environment at another position in a document, without constants of a shader.
    pub fn elsewhere(&mut self, position: Position) -> At<'_, 'a> {
        self.symbols.at(position, None)
    }

    /// Returns the target for the name of a provided resource, as [`SymbolTable::find_scene`] does.
    pub fn find_scene(&mut self, name: &str) -> Option<Reported<Target>> {
        self.symbols.find_scene(name, self.position.scope)
    }

    /// True if [`find_scene`](Self::find_scene) finds a target for the name. The plan relies on the
    /// answer.
    pub fn is_of_scene(&mut self, name: &str) -> bool {
        self.find_scene(name).is_some() || self.symbols.ask(name).is_some()
    }

    /// Returns the resource, or part of it, that a reference at this position means.
    pub fn resolve(&mut self, reference: &Reference) -> Reported<Target> {
        Ok(self.resource(reference)?.0)
    }
}
