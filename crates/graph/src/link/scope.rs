//! Meaning of the names of the pass that is linked.

use super::{
    layouts::Layouts,
    pass::{Access, Usage},
};
use crate::{
    diagnostics::{
        diagnostic::Diagnostic,
        reports::{ErrorGuaranteed, Reported, Reports},
    },
    errors::{instantiate::InterfaceError, link::LinkError},
    expressions::eval,
    instantiate::{
        flat::Inherited, lower::LoweredPass, params::BoundParam, scopes::Position,
        symbols::SymbolTable,
    },
    kinds::step::{Operand, Program, ShaderUse},
    language::{
        name::{Name, wgsl_identifier},
        syntax::{Expr, Reference},
        value::Value,
    },
    param::{Param, ParamType, ParamValue},
    request::PlanRequest,
    resource::{Origin, Resource, ResourceId, ResourceKind, Sampler, Target},
    shader::reflect::{Global, Shader},
    source::span::{Located, Span},
};
use std::{collections::BTreeSet, sync::Arc};

/// The symbols of a graph, as one pass after the other sees them.
pub(super) struct PassScope<'a> {
    symbols: SymbolTable<'a>,
    pub layouts: Layouts,
    /// The name of the pass.
    pub pass: Located<String>,
    /// Its reads and writes so far.
    pub accesses: Vec<Access>,
    position: Position,
    /// Its own buffers; of a capture, its source and destination.
    scratch: Vec<Target>,
    set: &'a [(Located<String>, Expr)],
    inherited_bind: Vec<Inherited<'a, Reference>>,
    inherited_set: Vec<Inherited<'a, Expr>>,
    /// The shader that has the pass's own bindings.
    pub own_shader: Option<Located<String>>,
    /// The bindings and values that a shader of the pass has asked for.
    asked: BTreeSet<String>,
}

/// A value that a shader asks for by name.
pub(super) enum Asked {
    /// A value from the entry or a group around it, or one of the document, with its place.
    Value(Value, Span),
    /// A param of the document; which one of the root document it is, unchanged.
    Param(Box<Param>, ParamValue, Option<String>),
    /// The number of the repetition.
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
            inherited_bind: Vec::new(),
            inherited_set: Vec::new(),
            own_shader: None,
            asked: BTreeSet::new(),
        }
    }

    /// The next pass is linked.
    pub fn enter(&mut self, pass: &mut LoweredPass<'a>) {
        self.position = pass.flat.position;
        let scratch = pass.scratch.iter().map(|id| self.symbols.whole(*id));
        self.scratch = scratch.collect();
        self.set = &pass.flat.entry.set;
        self.inherited_bind = std::mem::take(&mut pass.flat.bind);
        self.inherited_set = std::mem::take(&mut pass.flat.set);
        self.own_shader = Some(pass.shader.clone());
        self.asked.clear();
    }

    /// A capture is linked: both ends are known by number, neither is a name of a document.
    pub fn enter_capture(&mut self, from: Target, to: Target) {
        self.scratch = vec![from, to];
    }

    pub fn into_symbols(self) -> SymbolTable<'a> {
        self.symbols
    }

    pub fn symbols(&self) -> &SymbolTable<'a> {
        &self.symbols
    }

    /// The mistakes so far.
    pub fn reports(&mut self) -> &mut Reports {
        &mut self.symbols.reports
    }

    pub fn report(&mut self, mistake: impl Into<Diagnostic>) -> ErrorGuaranteed {
        self.symbols.reports.report(mistake)
    }

    /// Reports something that this adapter cannot do.
    pub fn unsupported(&mut self, mistake: impl Into<Diagnostic>) -> Reported<()> {
        self.symbols.reports.unsupported(mistake)
    }

    /// A result whose mistake is reported.
    pub fn check<T>(&mut self, result: Result<T, impl Into<Diagnostic>>) -> Reported<T> {
        self.symbols.reports.check(result)
    }

    /// Notes that a step reads or writes a whole part.
    pub fn access(
        &mut self,
        target: &Target,
        (reads, writes, fully_overwrites): (bool, bool, bool),
        usage: Usage,
        span: &Span,
    ) {
        self.accesses.push(Access {
            resource: target.id,
            part: target.part.clone(),
            reads,
            writes,
            fully_overwrites,
            triggers: true,
            usage,
            span: span.clone(),
            step: 0,
        });
    }

    /// Adds a resource that no document names.
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

    /// Resolves a reference of the pass's document.
    pub fn resolve(&mut self, reference: &Reference) -> Reported<Target> {
        self.symbols.resolve(reference, self.position)
    }

    /// Resolves a name of a command.
    pub fn resolve_full(&mut self, name: &str) -> Option<Reported<Target>> {
        self.symbols.find_full(name)
    }

    /// Resolves an operand of a step. Returns its name and place, too, for messages.
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

    /// Last frame's version of a resource is there to be read, and so is what the document holds.
    pub fn writable(&mut self, id: ResourceId, span: &Span) -> Reported<()> {
        let Resource { name, origin, .. } = self.get(id);
        let span = span.clone();
        let error = match origin {
            Origin::Previous(base) => {
                let of = self.get(*base).name.clone();
                LinkError::WritesPrevious { of, span }
            }
            Origin::Constant => {
                let name = name.clone();
                LinkError::WritesConstant { name, span }
            }
            Origin::Own | Origin::Host => return Ok(()),
        };
        Err(self.report(error))
    }

    /// The shader of a program; those that the document names were loaded with it.
    pub fn shader(&mut self, program: &Program) -> Reported<Arc<Shader>> {
        let Some(name) = &program.shader else {
            return Err(self.report(LinkError::NoShader));
        };
        let instance = self.symbols.scopes.document(self.position.scope);
        let shader = ShaderUse {
            name: name.clone(),
            imports: program.imports.clone(),
        };
        let shaders = &self.symbols.graph.shaders;
        match shaders.get(&instance.document, &shader, &instance.replaced) {
            Some(shader) => shader.clone(),
            // A kind names another one for other values.
            None => Err(shaders.incomplete.unwrap_or_else(|| {
                self.symbols
                    .reports
                    .report(LinkError::ShaderNotLoaded(name.clone()))
            })),
        }
    }

    /// Finds the target of a global: bound by a group, else of that name.
    pub fn target(&mut self, global: &Global) -> Reported<Target> {
        let mut said = self.inherited_bind.iter();
        if let Some(&said) = said.find(|said| said.name.value == global.name) {
            return self.symbols.resolve(said.value, said.position);
        }
        let scope = self.position.scope;
        if let Some(found) = self.symbols.find_global(&global.name, scope) {
            return found;
        }
        if let Some(reported) = self.symbols.scopes.document(scope).incomplete {
            return Err(reported);
        }
        if let Some(name) = global.name.strip_suffix("_previous")
            && let Some(base) = self.symbols.find_global(name, scope)
            && let Some(kept) = self.symbols.kept(base?.id)
        {
            return Err(self.report(InterfaceError::NoPrevious {
                name: global.name.clone(),
                span: global.span.clone(),
                what: "kept".to_owned(),
                kept: Some(kept),
            }));
        }
        let known = self.symbols.known(scope);
        let known = self
            .symbols
            .reports
            .known(known.iter().map(|name| wgsl_identifier(name)));
        Err(self.report(LinkError::UnknownGlobal {
            global: global.name.clone(),
            span: global.span.clone(),
            pass: self.pass.clone(),
            known,
        }))
    }

    /// The sampler that a global of a program is, bound to an operand or found by its name.
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

    /// The value that a shader asks for: set by the entry, else the index of a repetition, else the
    /// param of that name.
    pub fn asked(&mut self, name: &str) -> Option<Reported<Asked>> {
        self.asked.insert(name.to_owned());
        let own = self.set.iter().find(|(set, _)| **set == *name);
        let own = own.map(|(_, expr)| (expr, self.position));
        let said = || {
            let mut said = self.inherited_set.iter();
            let said = said.find(|said| said.name.value == name)?;
            Some((said.value, said.position))
        };
        if let Some((expr, position)) = own.or_else(said) {
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

    /// The document's param that a shader calls so.
    pub fn param(&self, name: &str) -> Option<&BoundParam> {
        let instance = self.symbols.scopes.document(self.position.scope);
        instance.params.wgsl_name(name)
    }

    /// The words of the document's param that a shader calls so.
    pub fn words(&self, name: &str) -> Option<&[Name]> {
        match &self.param(name)?.param.ty {
            ParamType::Choice(words) => Some(words),
            _ => None,
        }
    }

    /// Names of the document's params.
    pub fn params(&self) -> impl Iterator<Item = &str> {
        let instance = self.symbols.scopes.document(self.position.scope);
        instance.params.names()
    }

    /// The kind of what is provided, under which the plan is made.
    pub fn kind(&mut self, name: &str) -> Option<f64> {
        let kind = self.symbols.kind_of_wgsl_name(name, self.position.scope)?;
        Some(f64::from(kind.number))
    }

    /// Reports what the entry binds or sets and no shader of it asks for.
    pub fn unasked(&mut self) -> Reported<()> {
        let mut wrong = None;
        for (name, _) in self.set {
            if !self.asked.contains(name.as_str()) {
                let shader = self.own_shader.as_ref();
                wrong = Some(self.symbols.reports.report(LinkError::UnusedSet {
                    shader: shader.map_or(String::new(), |shader| shader.value.clone()),
                    name: name.clone(),
                    known: self.asked.iter().cloned().collect(),
                }));
            }
        }
        wrong.map_or(Ok(()), Err)
    }
}
