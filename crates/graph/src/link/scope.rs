//! Names that the pass being linked can use.

use super::layouts::Layouts;
use super::pass::{Access, Usage};
use crate::diagnostics::{Diagnostic, ErrorGuaranteed, Reported};
use crate::errors::instantiate::InterfaceError;
use crate::errors::link::LinkError;
use crate::expressions::eval;
use crate::instantiate::{BoundParam, LoweredPass, Position, Round, Settings, SymbolTable};
use crate::kinds::{Operand, Program};
use crate::language::{Expr, Name, Reference, Value, wgsl_identifier};
use crate::param::{Param, ParamType, ParamValue};
use crate::request::PlanRequest;
use crate::resource::{Origin, Resource, ResourceId, ResourceKind, Sampler, Target};
use crate::shader::{Global, Shader};
use crate::source::{Located, Span};
use std::{collections::BTreeSet, sync::Arc};

/// Names and resources of a graph as the pass that is being linked sees them, with the reads,
/// writes and layouts found so far.
pub(super) struct PassScope<'a> {
    pub symbols: SymbolTable<'a>,
    /// Layouts that shaders of the passes linked so far declare for buffers.
    pub layouts: Layouts,
    /// Full name of the pass that is being linked, with its place.
    pub pass: Located<String>,
    /// Reads and writes by the steps of the pass that were linked so far.
    pub accesses: Vec<Access>,
    position: Position,
    /// Buffers that only the pass uses; for a capture, its source and destination.
    scratch: Vec<Target>,
    set: &'a [(Located<String>, Expr)],
    inherited: Settings<'a>,
    /// Name of the shader that the pass's own `bind` and `set` are for; `None` before the first
    /// pass.
    pub own_shader: Option<Located<String>>,
    /// Names of the bindings and values that shaders of the pass have asked for.
    asked: BTreeSet<String>,
    /// The round that the pass belongs to, of a group that ends early.
    pub round: Option<Round<'a>>,
    /// Buffers `goes` of the rounds that a pass has begun.
    pub begun: BTreeSet<ResourceId>,
}

/// A value that a shader asks for by name.
pub(super) enum Asked {
    /// A value from the entry, from a group around it or from the document, with its place.
    Value(Value, Span),
    /// A param of the document, its value, and the name of the root document's param that it is
    /// unchanged (if any).
    Param(Box<Param>, ParamValue, Option<String>),
    /// The index of the repetition.
    Index(u32),
}

impl<'a> PassScope<'a> {
    pub fn new(symbols: SymbolTable<'a>) -> Self {
        Self {
            position: symbols.root(),
            pass: Located::new(String::new(), symbols.graph.place()),
            symbols,
            layouts: Layouts::default(),
            accesses: Vec::new(),
            scratch: Vec::new(),
            set: &[],
            inherited: Settings::default(),
            own_shader: None,
            asked: BTreeSet::new(),
            round: None,
            begun: BTreeSet::new(),
        }
    }

    /// Begins the linking of `pass`, whose inherited bindings and values are moved here.
    pub fn enter(&mut self, pass: &mut LoweredPass<'a>) {
        self.position = pass.flat.position;
        let scratch = pass.scratch.iter().map(|id| self.symbols.whole(*id));
        self.scratch = scratch.collect();
        self.set = &pass.flat.entry.set;
        self.inherited = std::mem::take(&mut pass.flat.inherited);
        self.own_shader = Some(pass.shader.clone());
        self.asked.clear();
        self.round = pass.flat.round;
    }

    /// Begins the linking of a capture, whose source and destination are known by id.
    pub fn enter_capture(&mut self, from: Target, to: Target) {
        self.round = None;
        self.scratch = vec![from, to];
    }

    pub fn report(&mut self, mistake: impl Into<Diagnostic>) -> ErrorGuaranteed {
        self.symbols.reports.report(mistake)
    }

    /// Reports that the device cannot do something that the graph needs: an error, or a warning and
    /// `Ok` if the device is not known.
    pub fn unsupported(&mut self, mistake: impl Into<Diagnostic>) -> Reported<()> {
        self.symbols.reports.unsupported(mistake)
    }

    /// Returns the value of `result`, or reports its mistake and returns the proof of that.
    pub fn check<T>(&mut self, result: Result<T, impl Into<Diagnostic>>) -> Reported<T> {
        self.symbols.reports.check(result)
    }

    /// Adds a use of `target` by the current step to the pass's accesses: true in the triple if the
    /// step reads the part, writes it, and overwrites all of it. `span` is the place that causes
    /// the use.
    pub fn access(&mut self, target: &Target, used: (bool, bool, bool), usage: Usage, span: &Span) {
        self.accesses.push(Access::new(target, used, usage, span));
    }

    /// Adds a resource of the graph that no document names, such as the copy for a capture. Returns
    /// a target that holds all of it.
    pub fn add(&mut self, name: String, kind: ResourceKind) -> Target {
        let id = self.symbols.add(Resource::new(name, kind, Origin::Own));
        self.symbols.whole(id)
    }

    pub fn get(&self, id: ResourceId) -> &Resource {
        self.symbols.get(id)
    }

    pub fn request(&self) -> &'a PlanRequest<'a> {
        self.symbols.request
    }

    /// Returns the resource, or part of it, that a reference in the pass's document means.
    pub fn resolve(&mut self, reference: &Reference) -> Reported<Target> {
        self.symbols.resolve(reference, self.position)
    }

    /// Returns the target of an operand of a step, and its name with its place, for messages.
    pub fn operand(&mut self, operand: &Operand) -> Reported<(Target, Located<String>)> {
        match operand {
            Operand::Named(reference) => Ok((self.resolve(reference)?, reference.located())),
            Operand::Scratch(scratch) => {
                let target = self.scratch[scratch.0].clone();
                let name = self.get(target.id).name.clone();
                Ok((target, Located::new(name, self.pass.span.clone())))
            }
        }
    }

    /// Returns the target for the name of a provided resource.
    pub fn provided(&mut self, name: &Located<String>) -> Reported<Target> {
        match self.symbols.find_scene(name, self.position.scope) {
            Some(target) => target,
            None => {
                let kind = "nothing that the host provides";
                Err(self.report(LinkError::NoCpuWork(name.clone(), kind)))
            }
        }
    }

    /// Checks that the resource `id` may be written. Content of the frame before (`.previous`) and
    /// content that the document gives are read-only.
    pub fn writable(&mut self, id: ResourceId, span: &Span) -> Reported<()> {
        let Resource { name, origin, .. } = self.get(id);
        let span = span.clone();
        let error = match origin {
            Origin::Previous(base) => {
                let base = self.get(*base).name.clone();
                LinkError::WritesPrevious(base, span)
            }
            Origin::Constant => {
                let name = name.clone();
                LinkError::WritesConstant(name, span)
            }
            Origin::Own | Origin::Host => return Ok(()),
        };
        Err(self.report(error))
    }

    /// Returns the shader of a program, which was loaded with the document.
    pub fn shader(&mut self, program: &Program) -> Reported<Arc<Shader>> {
        let Some(shader) = program.shader_use() else {
            return Err(self.report(LinkError::NoShader));
        };
        let instance = self.symbols.scopes.document(self.position.scope);
        let shaders = &self.symbols.graph.shaders;
        match shaders.get(&instance.document, &shader, &instance.replaced) {
            Some(shader) => shader,
            // A kind names another one for other values.
            None => Err(shaders.incomplete.unwrap_or_else(|| {
                let reports = &mut self.symbols.reports;
                reports.report(LinkError::ShaderNotLoaded(shader.name))
            })),
        }
    }

    /// Returns the declarations of a program's shader that is not valid; `None` of a valid one.
    pub fn declarations(&self, program: &Program) -> Option<Arc<Shader>> {
        let instance = self.symbols.scopes.document(self.position.scope);
        let (shaders, shader) = (&self.symbols.graph.shaders, program.shader_use()?);
        shaders.declarations(&instance.document, &shader, &instance.replaced)
    }

    /// True if a global means something here that a pass does not bind itself.
    pub fn is_known(&mut self, global: &str) -> bool {
        let scope = self.position.scope;
        let mut inherited = self.inherited.bind.iter();
        inherited.any(|bound| bound.name.value == global)
            || self.symbols.find_global(global, scope).is_some()
    }

    /// Returns the target of a shader's global that the pass itself does not bind: bound by a group
    /// around the pass, or else of the same name.
    pub fn target(&mut self, global: &Global) -> Reported<Target> {
        let mut inherited = self.inherited.bind.iter();
        if let Some(bound) = inherited.find(|bound| bound.name.value == global.name) {
            return self.symbols.resolve(bound.value, bound.position);
        }
        let scope = self.position.scope;
        if let Some(target) = self.symbols.find_global(&global.name, scope) {
            return target;
        }
        if let Some(reported) = self.symbols.scopes.document(scope).incomplete {
            return Err(reported);
        }
        if let Some(name) = global.name.strip_suffix("_previous")
            && let Some(base) = self.symbols.find_global(name, scope)
            && let Some(kept) = self.symbols.kept(base?.id)
        {
            return Err(self.report(InterfaceError::NoPrevious {
                name: global.located(),
                what: "kept".to_owned(),
                kept: Some(kept),
            }));
        }
        let names = self.symbols.known(scope);
        let names = names.iter().map(|name| wgsl_identifier(name));
        let materials = self.symbols.reports.known(names);
        Err(self.report(LinkError::UnknownGlobal {
            global: global.located(),
            pass: self.pass.clone(),
            materials,
        }))
    }

    /// Returns the sampler for a global of a program, bound by the pass or found by its name;
    /// `None` if there is none.
    pub fn sampler(&mut self, program: &Program, global: &str) -> Option<&Sampler> {
        let mut bound = program.bind.iter();
        let bound = bound.find(|(name, _)| name.value == global);
        let target = match bound {
            Some((_, Operand::Named(reference))) => self.resolve(reference),
            Some((_, Operand::Scratch(_))) => return None,
            None => self.symbols.find_global(global, self.position.scope)?,
        };
        match &self.get(target.ok()?.id).kind {
            ResourceKind::Sampler(sampler) => Some(sampler),
            _ => None,
        }
    }

    /// Returns the value for a name that a shader asks for: set by the entry or a group, or else
    /// the index of the repetition, the param or the value of that name. `None` for an unknown
    /// name.
    pub fn asked(&mut self, name: &str) -> Option<Reported<Asked>> {
        self.asked.insert(name.to_owned());
        let own = self.set.iter().find(|(set, _)| **set == *name);
        let own = own.map(|(_, expr)| (expr, self.position));
        let inherited = || {
            let mut settings = self.inherited.set.iter();
            let setting = settings.find(|setting| setting.name.value == name)?;
            Some((setting.value, setting.position))
        };
        if let Some((expr, position)) = own.or_else(inherited) {
            let value = eval::value(expr, &mut self.symbols.at(position, None));
            return Some(value.map(|value| Asked::Value(value, expr.span.clone())));
        }
        if name == "index"
            && let Some(index) = self.symbols.scopes.index(self.position, None)
        {
            return Some(Ok(Asked::Index(index)));
        }
        let Some(bound) = self.param(name) else {
            let scope = self.position.scope;
            let id = self.symbols.scopes.find_wgsl_value(scope, name)?;
            let value = self.symbols.value(id);
            let span = self.symbols.value_span(id);
            return Some(value.map(|value| Asked::Value(value, span.clone())));
        };
        let value = bound.value.clone();
        Some(value.map(|value| Asked::Param(bound.param.clone().into(), value, bound.root.clone())))
    }

    /// Returns the param of the pass's document that a shader finds under the WGSL identifier
    /// `name`; `None` if there is no such param.
    pub fn param(&self, name: &str) -> Option<&BoundParam> {
        let instance = self.symbols.scopes.document(self.position.scope);
        instance.params.wgsl_name(name)
    }

    /// Returns the words of the `Choice` param that a shader finds under the WGSL identifier
    /// `name`; `None` for any other param or name. The shader sees the index of the chosen word in
    /// this slice, from 0.
    pub fn words(&self, name: &str) -> Option<&[Name]> {
        match &self.param(name)?.param.ty {
            ParamType::Choice(words) => Some(words),
            _ => None,
        }
    }

    /// Iterates over the names of the params of the pass's document.
    pub fn params(&self) -> impl Iterator<Item = &str> {
        let instance = self.symbols.scopes.document(self.position.scope);
        instance.params.names()
    }

    /// Returns the value for an overridable constant such as `light_kind`: the number of the kind
    /// of the provided resource; `None` for other constants.
    pub fn kind(&mut self, name: &str) -> Option<f64> {
        let kind = self.symbols.kind_of_wgsl_name(name, self.position.scope)?;
        Some(f64::from(kind.number))
    }

    /// Reports each value that the pass's entry sets (`set`) and none of its shaders takes.
    pub fn unasked(&mut self) -> Reported<()> {
        let mut wrong = None;
        for (name, _) in self.set {
            if !self.asked.contains(name.as_str()) {
                let shader = self.own_shader.as_ref();
                wrong = Some(self.symbols.reports.report(LinkError::UnusedSet {
                    shader: shader.map_or(String::new(), |shader| shader.value.clone()),
                    name: name.clone(),
                    names: self.asked.iter().cloned().collect(),
                }));
            }
        }
        wrong.map_or(Ok(()), Err)
    }
}
