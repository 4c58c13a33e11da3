//! A document is called as a shader is: inputs and params by name or by what the include says,
//! outputs come back.

use super::{
    build::{Builder, EntryContext},
    flat::{Interface, Merge},
    merge::{Content, Site},
    params::{Given, Params, SetParam},
    scopes::{Instance, InstanceId, Names, Outer, Position, ScopeId, Symbol},
};
use crate::{
    diagnostics::reports::ErrorGuaranteed,
    document::{
        materials::{Input, InputKind, Material},
        typed::{Document, Entry, Include, Output},
    },
    errors::instantiate::InterfaceError,
    language::{
        name::Name,
        syntax::{Expr, ExprKind, Reference},
    },
    resource::{ResourceKind, Target},
    source::span::Located,
};
use std::{collections::BTreeMap, sync::Arc};

/// A material here that an output is written into, with the place that says so.
type Bound = (Located<String>, Result<Target, ErrorGuaranteed>);

/// Settings of an include for names of its document, its own before those of groups.
struct Overrides<'e> {
    bind: Vec<(&'e Located<String>, &'e Reference, Position)>,
    set: Vec<(&'e Located<String>, &'e Expr, Position)>,
}

/// Where an include stands.
fn outer(
    entry: &Entry,
    position: Position,
    has_namespace: bool,
    context: &EntryContext<'_>,
) -> Outer {
    Outer {
        scope: position.scope,
        namespace: has_namespace.then(|| {
            let suffix = position
                .index
                .map_or(String::new(), |index| format!("[{index}]"));
            format!("{}{suffix}.", entry.name.value)
        }),
        private: context.prefix.clone(),
    }
}

/// True if a document writes into one of its inputs.
fn is_output(document: &Document, input: &Input) -> bool {
    let mut outputs = document.outputs.iter();
    outputs.any(|output| output.material.path() == *input.name.as_str())
}

impl<'a> Builder<'a, '_> {
    /// The names that one instance of an include gives; where it has no name of its own and is not
    /// repeated, they are declared here.
    pub fn include(
        &mut self,
        entry: &'a Entry,
        include: &'a Include,
        position: Position,
        context: &EntryContext<'a>,
    ) -> Result<Names, ErrorGuaranteed> {
        let document = match &include.document {
            Some(Ok(document)) => document,
            Some(Err(reported)) => {
                let instance = self.symbols.scopes.instance_of(position.scope);
                self.symbols.scopes.instance_mut(instance).incomplete = Some(*reported);
                return Err(*reported);
            }
            None => return Ok(Names::new()),
        };
        self.require(document);
        let said = self.said(entry, document, position, context);
        let has_namespace = include.is_named || position.index.is_some();
        let params = self.params(entry, include, document, &said, position);
        let (scene, overrides) = self.outside(entry, document, &said, position, has_namespace);
        let inputs: Vec<Result<Target, ErrorGuaranteed>> = document
            .inputs
            .iter()
            .map(|input| self.input(input, document, include, &said, position))
            .collect();
        let around = self.symbols.scopes.instance_of(position.scope);
        let replaced = self.symbols.scopes.instance(around).replaced.clone();
        // With a name, or in a repetition, an include is one of its own; so is one that writes into
        // what it is given.
        let may_merge = self.merges
            && !has_namespace
            && overrides.is_empty()
            && self.symbols.scopes.index(position, None).is_none()
            && !document
                .inputs
                .iter()
                .any(|input| is_output(document, input));
        let content = may_merge.then(|| {
            let mut bound = self.symbols.scopes.bound_scene(around);
            bound.extend(scene.clone());
            let run = context.run.clone();
            Content::new(document, &params, &inputs, bound, &replaced, run)
        });
        let content = content.flatten();
        if let Some(names) = self.stands_above(content.as_ref(), include) {
            self.give(entry, document, &names, (position, has_namespace))?;
            return Ok(names);
        }
        let first_resource = self.symbols.resources.len();
        let outer = outer(entry, position, has_namespace, context);
        let instance = self.symbols.scopes.add_instance(Instance {
            document: Arc::clone(document),
            params: Arc::new(params),
            scene,
            outer: Some(outer),
            overrides,
            replaced,
            incomplete: None,
        });
        let scope = self
            .symbols
            .scopes
            .add_scope(instance, None, String::new(), None);
        let read_only = self.declare_inputs(scope, document, inputs);
        let inner = context.inside(scope);
        self.document(document, &inner);
        let (names, outputs) = self.outputs(document, &said, Position { scope, index: None });
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
        self.give(entry, document, &names, (position, has_namespace))?;
        Ok(names)
    }

    /// The names that an include of the same content above gives, which stands for this one.
    fn stands_above(&mut self, content: Option<&Content>, include: &Include) -> Option<Names> {
        let content = content?;
        let site = self.sites.iter().find(|site| site.content == *content)?;
        self.merged.push(Merge {
            between: site.end..self.passes.len(),
            inputs: content.inputs.iter().map(|target| target.id).collect(),
            owned: site.owned.clone(),
            graph: include.graph.value.clone(),
            span: include.graph.span.clone(),
        });
        Some(site.names.clone())
    }

    /// Makes what an include is given known in it; returns what it may only read.
    fn declare_inputs(
        &mut self,
        scope: ScopeId,
        document: &Document,
        inputs: Vec<Result<Target, ErrorGuaranteed>>,
    ) -> Vec<(Located<Name>, Target)> {
        let mut read_only = Vec::new();
        for (input, target) in document.inputs.iter().zip(inputs) {
            if let Ok(target) = &target
                && !is_output(document, input)
            {
                read_only.push((input.name.clone(), target.clone()));
            }
            let symbol = target.map_or_else(Symbol::Invalid, Symbol::Target);
            self.symbols
                .scopes
                .declare(scope, &input.name.value, symbol);
        }
        read_only
    }

    /// Makes what an include gives known where it stands.
    fn give(
        &mut self,
        entry: &Entry,
        document: &Document,
        names: &Names,
        (position, has_namespace): (Position, bool),
    ) -> Result<(), ErrorGuaranteed> {
        let scopes = &mut self.symbols.scopes;
        let name = &entry.name.value;
        if let Some(reported) = document.broken_outputs {
            let context = scopes.instance_of(position.scope);
            scopes.instance_mut(context).incomplete = Some(reported);
            if has_namespace {
                scopes.declare(position.scope, name, Symbol::Invalid(reported));
            }
            return Err(reported);
        }
        if has_namespace && position.index.is_none() {
            scopes.declare(position.scope, name, Symbol::Namespace(names.clone()));
        } else if !has_namespace {
            for (name, symbol) in names {
                scopes.declare(position.scope, name, symbol.clone());
            }
        }
        Ok(())
    }

    /// Returns the settings of an include, and those of groups around it for names that its
    /// document asks for.
    fn said<'e>(
        &mut self,
        entry: &'e Entry,
        document: &Document,
        position: Position,
        context: &EntryContext<'e>,
    ) -> Overrides<'e>
    where
        'a: 'e,
        'e: 'a,
    {
        let own = |name: &str| entry.bind.iter().any(|(own, _)| **own == *name);
        let scope = position.scope;
        let mut inherited = context.bind.clone();
        inherited.retain(|said| {
            let is_border = document
                .inputs
                .iter()
                .any(|input| input.name.as_str() == said.name.as_str())
                || document
                    .outputs
                    .iter()
                    .any(|output| output.name.as_str() == said.name.as_str());
            let asks = is_border || self.symbols.find_scene(said.name, scope).is_some();
            asks && !own(said.name)
        });
        let set_here = |name: &str| entry.set.iter().any(|(own, _)| **own == *name);
        let mut set = context.set.clone();
        set.retain(|said| {
            let asks = document
                .params
                .iter()
                .any(|param| param.name.value == **said.name);
            asks && !set_here(said.name)
        });
        self.mark(&inherited, &set);
        let bind = entry
            .bind
            .iter()
            .map(|(name, value)| (name, value, position));
        let values = entry
            .set
            .iter()
            .map(|(name, value)| (name, value, position));
        Overrides {
            bind: bind
                .chain(
                    inherited
                        .iter()
                        .map(|said| (said.name, said.value, said.position)),
                )
                .collect(),
            set: values
                .chain(
                    set.iter()
                        .map(|said| (said.name, said.value, said.position)),
                )
                .collect(),
        }
    }

    fn params(
        &mut self,
        entry: &Entry,
        include: &Include,
        document: &Document,
        said: &Overrides<'_>,
        position: Position,
    ) -> Params {
        let mut set: BTreeMap<String, SetParam> = BTreeMap::new();
        for (name, expr, at) in &said.set {
            if !document
                .params
                .iter()
                .any(|param| param.name.value == name.value)
            {
                let known = document.params.iter().map(|param| param.name.value.clone());
                let known = self.reports.known(known);
                self.reports.report(InterfaceError::Unused {
                    document: document.file.name.to_string(),
                    name: (*name).clone(),
                    known,
                });
                continue;
            }
            let params = &self.symbols.scopes.document(at.scope).params;
            let value = match params.forwarded(expr) {
                Some(value) => value,
                None => expr.value(&mut self.symbols.at(*at, None, self.reports)),
            };
            let given = SetParam {
                roots: self.symbols.roots(at.scope, expr),
                expr: Located::new((*expr).clone(), expr.span.clone()),
                value,
            };
            set.insert(name.value.clone(), given);
        }
        self.values_asked(include, document, position, &mut set);
        let outer = Arc::clone(&self.symbols.scopes.document(position.scope).params);
        let exposed = include.expose.iter().map(|name| {
            let own = if include.is_named {
                format!("{}.{}", entry.name.value, **name)
            } else {
                name.value.clone()
            };
            (name.as_str(), own)
        });
        let given = Given {
            exposed: exposed.collect(),
            outer: &outer,
            span: &include.graph.span,
            context: self.symbols.request.surroundings(),
        };
        given.bind(document, &set, self.reports)
    }

    /// Params without a default that the include does not set are filled by values of that name.
    fn values_asked(
        &mut self,
        include: &Include,
        document: &Document,
        position: Position,
        set: &mut BTreeMap<String, SetParam>,
    ) {
        for param in &document.params {
            let name = &param.name.value;
            let is_asked = param.default.is_none()
                && !set.contains_key(name)
                && include.expose.iter().all(|exposed| **exposed != *name);
            let outer = &self.symbols.scopes.document(position.scope).params;
            if !is_asked || outer.bound(name).is_some() {
                continue;
            }
            let Some(id) = self.symbols.scopes.find_value(position.scope, name) else {
                continue;
            };
            let span = include.graph.span.clone();
            let expr = Expr::new(ExprKind::Param(name.clone()), span.clone());
            let given = SetParam {
                roots: self.symbols.roots(position.scope, &expr),
                value: self.symbols.value(id, self.reports),
                expr: Located::new(expr, span),
            };
            set.insert(name.clone(), given);
        }
    }

    /// Returns the bindings of an include besides inputs: outputs, which are written into a
    /// material here, and names of the scene.
    fn outside(
        &mut self,
        entry: &Entry,
        document: &Document,
        said: &Overrides<'_>,
        position: Position,
        has_namespace: bool,
    ) -> (
        BTreeMap<String, Result<Target, ErrorGuaranteed>>,
        BTreeMap<String, Bound>,
    ) {
        let (mut scene, mut overrides) = (BTreeMap::new(), BTreeMap::new());
        for (name, reference, at) in &said.bind {
            if document
                .inputs
                .iter()
                .any(|input| input.name.as_str() == name.as_str())
            {
                continue;
            }
            let output = document
                .outputs
                .iter()
                .find(|output| output.name.as_str() == name.as_str());
            if output.is_none() && self.symbols.find_scene(name, position.scope).is_none() {
                let known = document
                    .inputs
                    .iter()
                    .map(|input| input.name.value.to_string());
                let outputs = document
                    .outputs
                    .iter()
                    .map(|output| output.name.value.to_string());
                let known = self.reports.known(known.chain(outputs));
                self.reports.report(InterfaceError::Unused {
                    document: document.file.name.to_string(),
                    name: (*name).clone(),
                    known,
                });
                continue;
            }
            let target = self.symbols.resolve(reference, *at, self.reports);
            match output {
                None => drop(scene.insert(name.value.clone(), target)),
                Some(output) => {
                    let key = output.material.path();
                    overrides.insert(key, ((*name).clone(), target));
                }
            }
        }
        for (output, bound) in self.passed_on(entry, document, position, has_namespace) {
            overrides.insert(output.material.path(), bound);
        }
        (scene, overrides)
    }

    /// Returns the outputs of an include that the document around it passes on. The include writes
    /// such an output into the material that the document's own output was bound to.
    fn passed_on<'d>(
        &self,
        entry: &Entry,
        document: &'d Document,
        position: Position,
        has_namespace: bool,
    ) -> Vec<(&'d Output, Bound)> {
        let context = self.symbols.scopes.document(position.scope);
        let known = |name: &Name| match (has_namespace, position.index) {
            (false, _) => Some(name.to_string()),
            (true, None) => Some(format!("{}.{name}", entry.name.value)),
            (true, Some(_)) => None,
        };
        let passed_on = document.outputs.iter().filter_map(|output| {
            let name = &output.name.value;
            let own = entry.bind.iter().any(|(bound, _)| **bound == **name);
            let bound = context.overrides.get(&known(name)?).filter(|_| !own)?;
            Some((output, bound.clone()))
        });
        passed_on.collect()
    }

    /// The material here that is written instead of one that the document declares.
    pub fn overridden(
        &mut self,
        instance: InstanceId,
        material: &Material,
    ) -> Option<Result<Target, ErrorGuaranteed>> {
        let overrides = &self.symbols.scopes.instance(instance).overrides;
        let (name, target) = overrides.get(material.name().as_str())?.clone();
        Some(target.and_then(|target| {
            let found = &self.symbols.get(target.id).kind;
            let fits = matches!(
                (material, found),
                (Material::Texture(_), ResourceKind::Texture(_))
                    | (Material::Buffer(_), ResourceKind::Buffer(_))
                    | (Material::Sampler(_), ResourceKind::Sampler(_))
            );
            if fits {
                Ok(target)
            } else {
                Err(self.reports.report(InterfaceError::BoundOutput {
                    name,
                    why: format!("this is {}", found.describe()),
                    declared: material.name().span.clone(),
                }))
            }
        }))
    }

    fn input(
        &mut self,
        input: &Input,
        document: &Document,
        include: &Include,
        said: &Overrides<'_>,
        position: Position,
    ) -> Result<Target, ErrorGuaranteed> {
        let name = &input.name.value;
        let bound = said
            .bind
            .iter()
            .find(|(bound, ..)| bound.as_str() == name.as_str());
        let (target, span) = match bound {
            Some((_, reference, at)) => {
                let target = self.symbols.resolve(reference, *at, self.reports)?;
                (target, reference.span.clone())
            }
            None => {
                let span = include.graph.span.clone();
                if self.symbols.scopes.find(position.scope, name).is_none() {
                    return Err(self.no_input(input, document, include, position));
                }
                let reference = Reference::new(Located::new(name.clone(), span.clone()));
                let target = self.symbols.resolve(&reference, position, self.reports)?;
                (target, span)
            }
        };
        let found = &self.symbols.get(target.id).kind;
        let fits = match (&input.kind, found) {
            (InputKind::Texture(None), ResourceKind::Texture(_)) => true,
            (InputKind::Texture(Some(format)), ResourceKind::Texture(texture)) => {
                texture.format == *format
            }
            (InputKind::Buffer, ResourceKind::Buffer(_) | ResourceKind::Provided(_)) => true,
            (InputKind::Sampler { compare }, ResourceKind::Sampler(sampler)) => {
                sampler.compare.is_some() == *compare
            }
            _ => false,
        };
        if fits {
            return Ok(target);
        }
        let found = match found {
            ResourceKind::Texture(texture) => format!("a texture {:?}", texture.format),
            other => other.describe().to_owned(),
        };
        Err(self.reports.report(InterfaceError::WrongInput {
            document: document.file.name.to_string(),
            name: name.to_string(),
            expected: input.kind.describe_with_format(),
            found,
            span,
            declared: input.name.span.clone(),
        }))
    }

    fn no_input(
        &mut self,
        input: &Input,
        document: &Document,
        include: &Include,
        position: Position,
    ) -> ErrorGuaranteed {
        if let Some(reported) = self.symbols.scopes.document(position.scope).incomplete {
            return reported;
        }
        let known = self
            .reports
            .known(self.symbols.scopes.known(position.scope));
        self.reports.report(InterfaceError::NoInput {
            document: document.file.name.to_string(),
            name: input.name.value.to_string(),
            kind: input.kind.describe_with_format(),
            span: include.graph.span.clone(),
            declared: input.name.span.clone(),
            known,
        })
    }

    /// Returns the names that a document gives, and every output with its target, to be compared
    /// with the writes.
    fn outputs(
        &mut self,
        document: &Document,
        said: &Overrides<'_>,
        position: Position,
    ) -> (Names, Vec<(Located<Name>, Target)>) {
        let (mut names, mut outputs) = (Names::new(), Vec::new());
        for output in &document.outputs {
            let name = &output.name;
            match self.is_there(output.condition.as_ref(), position.scope) {
                Ok(true) => {}
                Ok(false) => continue,
                Err(reported) => {
                    names.insert(name.value.clone(), Symbol::Invalid(reported));
                    continue;
                }
            }
            let value = self
                .symbols
                .scopes
                .find_value(position.scope, &output.material.path());
            if let Some(id) = value {
                names.insert(name.value.clone(), Symbol::Value(id));
                continue;
            }
            let target = self
                .symbols
                .resolve(&output.material, position, self.reports);
            if let Ok(target) = &target {
                outputs.push((name.clone(), target.clone()));
            }
            // A bound output has its name here already.
            let path = output.material.path();
            let is_input = document
                .inputs
                .iter()
                .any(|input| input.name.as_str() == path);
            let is_bound = said
                .bind
                .iter()
                .any(|(bound, ..)| bound.as_str() == name.as_str());
            if !is_input && !is_bound {
                let symbol = target.map_or_else(Symbol::Invalid, Symbol::Target);
                names.insert(name.value.clone(), symbol);
            }
        }
        (names, outputs)
    }
}
