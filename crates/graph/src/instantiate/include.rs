//! Includes: a document gets inputs and params by name or by the settings of the include, and gives
//! its outputs back.

use super::flat::{EntryContext, PlanInputs};
use super::params::{Given, Params, SetParam};
use super::scopes::{Instance, Names, Outer, Position, ScopeId, Scopes, Symbol};
use super::settings::{Inherited, Settings};
use super::symbols::At;
use crate::diagnostics::Reported;
use crate::document::{Document, Entry, Include, Input, InputKind, Material};
use crate::errors::instantiate::InterfaceError;
use crate::expressions::{Environment, eval};
use crate::language::{Expr, ExprKind, Name, Reference};
use crate::resource::{ResourceKind, Target};
use crate::source::Located;
use std::{collections::BTreeMap, sync::Arc};

/// Material of the outer document that an output is written into, with the place that says so.
type Bound = (Located<String>, Reported<Target>);

/// One repetition of an include, with all bindings and values for its document.
pub(super) struct Call<'e> {
    entry: &'e Entry,
    include: &'e Include,
    document: &'e Document,
    position: Position,
    /// True if the include has a name of its own or is repeated, so that the names of its outputs
    /// have a prefix in the including document.
    pub has_namespace: bool,
    /// Settings of names of the included document: those of the include before those of groups.
    pub settings: Settings<'e>,
}

fn has_input(document: &Document, name: &str) -> bool {
    let mut inputs = document.inputs.iter();
    inputs.any(|input| input.name.as_str() == name)
}

/// True if an input takes a resource of this kind.
pub(super) fn takes(input: &InputKind, kind: &ResourceKind) -> bool {
    match (input, kind) {
        (InputKind::Texture(format), ResourceKind::Texture(texture)) => {
            format.is_none_or(|format| format == texture.format)
        }
        (InputKind::Buffer, ResourceKind::Buffer(_) | ResourceKind::Provided(_)) => true,
        (InputKind::Sampler { compare }, ResourceKind::Sampler(sampler)) => {
            sampler.compare.is_some() == *compare
        }
        _ => false,
    }
}

/// True if an input of a document is one of its outputs, too, so that the document may write it.
pub(super) fn is_output(document: &Document, input: &Input) -> bool {
    let mut outputs = document.outputs.iter();
    outputs.any(|output| output.material.path() == *input.name.as_str())
}

/// Returns the settings of the groups around an include that have a name in its document.
pub(super) fn said<'e>(
    document: &Document,
    around: &Settings<'e>,
    at: &mut At<'_, '_>,
) -> Settings<'e> {
    let mut settings = around.clone();
    settings.bind.retain(|bound| {
        let inputs = document.inputs.iter().map(|input| &input.name);
        let mut border = inputs.chain(document.outputs.iter().map(|output| &output.name));
        border.any(|name| name.as_str() == bound.name.as_str()) || at.is_of_scene(bound.name)
    });
    let is_param = |setting: &Inherited<'_, Expr>| document.param(setting.name).is_some();
    settings.set.retain(is_param);
    settings
}

/// Returns the material of the including document that is written instead of `material`, because
/// the include binds it to an output; `None` without such a binding.
pub(super) fn overridden(material: &Material, at: &mut At<'_, '_>) -> Option<Symbol> {
    let overrides = &at.instance().overrides;
    let (name, target) = overrides.get(material.name().as_str())?.clone();
    let target = target.and_then(|target| {
        let kind = &at.symbols.get(target.id).kind;
        let fits = matches!(
            (material, kind),
            (Material::Texture(_), ResourceKind::Texture(_))
                | (Material::Buffer(_), ResourceKind::Buffer(_))
                | (Material::Sampler(_), ResourceKind::Sampler(_))
        );
        if fits {
            return Ok(target);
        }
        let why = format!("this is {}", kind.describe());
        let declared = material.name().span.clone();
        Err(at.report(InterfaceError::BoundOutput(name, why, declared)))
    });
    Some(target.map_or_else(Symbol::Invalid, Symbol::Target))
}

impl<'e> Call<'e> {
    /// Creates the call of an include at a position of the including document. Bindings and values
    /// of the include itself come before `of_groups`, those of groups around it.
    pub fn new(
        entry: &'e Entry,
        include: &'e Include,
        document: &'e Document,
        of_groups: &Settings<'e>,
        position: Position,
    ) -> Self {
        Self {
            entry,
            include,
            document,
            position,
            has_namespace: include.is_named || position.index.is_some(),
            settings: Settings::own(entry, position).within(of_groups),
        }
    }

    /// Returns the place of the include, with the prefixes of the included document's names there.
    pub fn outer(&self, context: &EntryContext<'_>) -> Outer {
        Outer {
            scope: self.position.scope,
            namespace: self.has_namespace.then(|| {
                let index = self.position.index;
                let suffix = index.map_or(String::new(), |index| format!("[{index}]"));
                format!("{}{suffix}.", self.entry.name.value)
            }),
            private: context.prefix.clone(),
        }
    }

    /// Declares the inputs of the included document in its scope; `inputs` has a target for each,
    /// in the same order. Returns those that the document may only read.
    pub fn declare_inputs(
        &self,
        scope: ScopeId,
        inputs: Vec<Reported<Target>>,
        scopes: &mut Scopes,
    ) -> Vec<(Located<Name>, Target)> {
        let mut read_only = Vec::new();
        for (input, target) in self.document.inputs.iter().zip(inputs) {
            if let Ok(target) = &target
                && !is_output(self.document, input)
            {
                read_only.push((input.name.clone(), target.clone()));
            }
            let symbol = target.map_or_else(Symbol::Invalid, Symbol::Target);
            scopes.declare(scope, &input.name.value, symbol);
        }
        read_only
    }

    /// Declares `names`, the outputs of the included document, in the including document. The error
    /// is the proof of a reported mistake in these outputs.
    pub fn give(&self, names: &Names, scopes: &mut Scopes) -> Reported<()> {
        let name = &self.entry.name.value;
        if let Some(reported) = self.document.broken_outputs {
            let context = scopes.instance_of(self.position.scope);
            scopes.instance_mut(context).incomplete = Some(reported);
            if self.has_namespace {
                scopes.declare(self.position.scope, name, Symbol::Invalid(reported));
            }
            return Err(reported);
        }
        if self.has_namespace && self.position.index.is_none() {
            scopes.declare(self.position.scope, name, Symbol::Namespace(names.clone()));
        } else if !self.has_namespace {
            for (name, symbol) in names {
                scopes.declare(self.position.scope, name, symbol.clone());
            }
        }
        Ok(())
    }

    /// Returns the params of the included document with their values, and reports mistakes in `set`
    /// to `at`, the place of the include.
    pub fn params(&self, at: &mut At<'_, '_>) -> Params {
        let mut set: BTreeMap<String, SetParam> = BTreeMap::new();
        for setting in &self.settings.set {
            let (name, expr, place) = (setting.name, setting.value, setting.position);
            if self.document.param(name).is_none() {
                let params = self.document.params.iter();
                self.unused(name, params.map(|param| param.name.value.clone()), at);
                continue;
            }
            let params = &at.symbols.scopes.document(place.scope).params;
            let value = match params.forwarded(expr) {
                Some(value) => value,
                None => eval::value(expr, &mut at.elsewhere(place)),
            };
            let given = SetParam {
                roots: at.symbols.roots(place.scope, expr),
                expr: Located::new(expr.clone(), expr.span.clone()),
                value,
            };
            set.insert(name.value.clone(), given);
        }
        self.values_asked(&mut set, at);
        let outer = Arc::clone(&at.instance().params);
        let exposed = self.include.expose.names.iter();
        let exposed =
            exposed.map(|name| (name.as_str(), self.entry.outer_name(self.include, name)));
        let given = Given {
            exposed: exposed.collect(),
            outer: &outer,
            span: &self.include.graph.span,
            context: at.symbols.request.surroundings(),
        };
        given.bind(self.document, &set, at.reports())
    }

    /// Sets params without a default that the include does not set to the outer document's values
    /// of their names.
    fn values_asked(&self, set: &mut BTreeMap<String, SetParam>, at: &mut At<'_, '_>) {
        for param in &self.document.params {
            let name = &param.name.value;
            let mut exposed = self.include.expose.names.iter();
            let is_asked = param.default.is_none()
                && !set.contains_key(name)
                && exposed.all(|exposed| **exposed != *name);
            let outer = &at.instance().params;
            if !is_asked || outer.bound(name).is_some() {
                continue;
            }
            let Some(id) = at.symbols.scopes.find_value(at.position.scope, name) else {
                continue;
            };
            let span = self.include.graph.span.clone();
            let expr = Expr::new(ExprKind::Param(name.clone()), span.clone());
            let given = SetParam {
                roots: at.symbols.roots(at.position.scope, &expr),
                value: at.symbols.value(id),
                expr: Located::new(expr, span),
            };
            set.insert(name.clone(), given);
        }
    }

    /// Reports a setting for a name that the document does not have; `names` lists the names that
    /// it has.
    fn unused(
        &self,
        name: &Located<String>,
        names: impl Iterator<Item = String>,
        at: &mut At<'_, '_>,
    ) {
        let names = at.reports().known(names);
        let document = self.document.file.name.to_string();
        at.report(InterfaceError::Unused(document, name.clone(), names));
    }

    /// Returns the bindings of the include that are not for inputs: first those for names of
    /// provided resources, by that name; then those for outputs, by the document's material that is
    /// replaced by a material of the including document.
    pub fn outside(
        &self,
        at: &mut At<'_, '_>,
    ) -> (BTreeMap<String, Reported<Target>>, BTreeMap<String, Bound>) {
        let (mut scene, mut overrides) = (BTreeMap::new(), BTreeMap::new());
        for setting in &self.settings.bind {
            let (name, reference, place) = (setting.name, setting.value, setting.position);
            if has_input(self.document, name.as_str()) {
                continue;
            }
            let mut outputs = self.document.outputs.iter();
            let output = outputs.find(|output| output.name.as_str() == name.as_str());
            if output.is_none() && at.find_scene(name).is_none() {
                let inputs = self.document.inputs.iter().map(|input| &input.name.value);
                let outputs = self.document.outputs.iter();
                let outputs = outputs.map(|output| &output.name.value);
                self.unused(name, inputs.chain(outputs).map(ToString::to_string), at);
                continue;
            }
            let target = at.elsewhere(place).resolve(reference);
            match output {
                None => drop(scene.insert(name.value.clone(), target)),
                Some(output) => {
                    let key = output.material.path();
                    overrides.insert(key, (name.clone(), target));
                }
            }
        }
        overrides.extend(self.passed_on(at.instance()));
        (scene, overrides)
    }

    /// Returns the outputs of an include that the document around it passes on. The include writes
    /// such an output into the material that the document's own output was bound to.
    fn passed_on(&self, context: &Instance) -> impl Iterator<Item = (String, Bound)> {
        let outer_name = |name: &Name| match (self.has_namespace, self.position.index) {
            (false, _) => Some(name.to_string()),
            (true, None) => Some(format!("{}.{name}", self.entry.name.value)),
            (true, Some(_)) => None,
        };
        self.document.outputs.iter().filter_map(move |output| {
            let name = &output.name.value;
            let own = self.entry.bind.iter().any(|(bound, _)| **bound == **name);
            let bound = context.overrides.get(&outer_name(name)?).filter(|_| !own)?;
            Some((output.material.path(), bound.clone()))
        })
    }

    /// Finds the binding of an input or output of the included document.
    fn bound(&self, name: &Name) -> Option<&Inherited<'e, Reference>> {
        let mut bound = self.settings.bind.iter();
        bound.find(|bound| bound.name.as_str() == name.as_str())
    }

    /// Returns the resource that is bound to an input of the included document: by the include, or
    /// else by its name in the including document.
    pub fn input(&self, input: &Input, at: &mut At<'_, '_>) -> Reported<Target> {
        let name = &input.name.value;
        let (target, span) = match self.bound(name) {
            Some(bound) => {
                let target = at.elsewhere(bound.position).resolve(bound.value)?;
                (target, bound.value.span.clone())
            }
            None => {
                let span = self.include.graph.span.clone();
                if at.symbols.scopes.find(at.position.scope, name).is_none() {
                    if let Some(reported) = at.instance().incomplete {
                        return Err(reported);
                    }
                    let names = at.symbols.scopes.known(at.position.scope);
                    let names = at.reports().known(names);
                    return Err(at.report(InterfaceError::NoInput {
                        document: self.document.file.name.to_string(),
                        name: input.name.value.to_string(),
                        kind: input.kind.describe_with_format(),
                        span: self.include.graph.span.clone(),
                        declared: input.name.span.clone(),
                        names,
                    }));
                }
                let reference = Reference::new(Located::new(name.clone(), span.clone()));
                let target = at.resolve(&reference)?;
                (target, span)
            }
        };
        let kind = &at.symbols.get(target.id).kind;
        if takes(&input.kind, kind) {
            return Ok(target);
        }
        let given = kind.describe_with_format();
        Err(at.report(InterfaceError::WrongInput {
            document: self.document.file.name.to_string(),
            name: name.to_string(),
            expected: input.kind.describe_with_format(),
            given,
            span,
            declared: input.name.span.clone(),
        }))
    }

    /// Returns the names that the included document gives, and each output that is not a value with
    /// its target. Outputs whose `if` is false are left out.
    pub fn outputs(
        &self,
        plan_inputs: &mut PlanInputs,
        at: &mut At<'_, '_>,
    ) -> (Names, Vec<(Located<Name>, Target)>) {
        let (mut names, mut outputs) = (Names::new(), Vec::new());
        for output in &self.document.outputs {
            let name = &output.name;
            match plan_inputs.is_there(output.condition.as_ref(), at) {
                Ok(true) => {}
                Ok(false) => continue,
                Err(reported) => {
                    names.insert(name.value.clone(), Symbol::Invalid(reported));
                    continue;
                }
            }
            let path = output.material.path();
            let value = at.symbols.scopes.find_value(at.position.scope, &path);
            if let Some(id) = value {
                names.insert(name.value.clone(), Symbol::Value(id));
                continue;
            }
            let target = at.resolve(&output.material);
            if let Ok(target) = &target {
                outputs.push((name.clone(), target.clone()));
            }
            // A bound output has its name here already.
            let is_input = has_input(self.document, &path);
            if !is_input && self.bound(name).is_none() {
                let symbol = target.map_or_else(Symbol::Invalid, Symbol::Target);
                names.insert(name.value.clone(), symbol);
            }
        }
        (names, outputs)
    }
}
