//! A document is called as a shader is: inputs and params by name or by what the include says,
//! outputs come back.

use super::{
    flat::{EntryContext, Inherited, PlanInputs},
    params::{Given, Params, SetParam},
    scopes::{Instance, Names, Outer, Position, ScopeId, Scopes, Symbol},
    symbols::At,
};
use crate::{
    diagnostics::reports::Reported,
    document::{
        materials::{Input, InputKind, Material},
        typed::{Document, Entry, Include, Output},
    },
    errors::instantiate::InterfaceError,
    expressions::eval::{self, Environment},
    language::{
        name::Name,
        syntax::{Expr, ExprKind, Reference},
    },
    resource::{ResourceKind, Target},
    source::span::Located,
};
use std::{collections::BTreeMap, sync::Arc};

/// A material here that an output is written into, with the place that says so.
type Bound = (Located<String>, Reported<Target>);

/// Settings of groups around an include that its document asks for.
type Said<'e> = (Vec<Inherited<'e, Reference>>, Vec<Inherited<'e, Expr>>);

/// Settings of an include for names of its document, its own before those of groups.
pub(super) struct Overrides<'e> {
    bind: Vec<(&'e Located<String>, &'e Reference, Position)>,
    set: Vec<(&'e Located<String>, &'e Expr, Position)>,
}

/// Where an include stands.
pub(super) fn outer(
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

fn has_input(document: &Document, name: &str) -> bool {
    let mut inputs = document.inputs.iter();
    inputs.any(|input| input.name.as_str() == name)
}

/// True if a document writes into one of its inputs.
pub(super) fn is_output(document: &Document, input: &Input) -> bool {
    let mut outputs = document.outputs.iter();
    outputs.any(|output| output.material.path() == *input.name.as_str())
}

/// Makes what an include is given known in it; returns what it may only read.
pub(super) fn declare_inputs(
    scope: ScopeId,
    document: &Document,
    inputs: Vec<Reported<Target>>,
    scopes: &mut Scopes,
) -> Vec<(Located<Name>, Target)> {
    let mut read_only = Vec::new();
    for (input, target) in document.inputs.iter().zip(inputs) {
        if let Ok(target) = &target
            && !is_output(document, input)
        {
            read_only.push((input.name.clone(), target.clone()));
        }
        let symbol = target.map_or_else(Symbol::Invalid, Symbol::Target);
        scopes.declare(scope, &input.name.value, symbol);
    }
    read_only
}

/// Makes what an include gives known where it stands.
pub(super) fn give(
    entry: &Entry,
    document: &Document,
    names: &Names,
    (position, has_namespace): (Position, bool),
    scopes: &mut Scopes,
) -> Reported<()> {
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
pub(super) fn said<'e>(
    entry: &'e Entry,
    document: &Document,
    context: &EntryContext<'e>,
    at: &mut At<'_, '_>,
) -> Said<'e> {
    let own = |name: &str| entry.bind.iter().any(|(own, _)| **own == *name);
    let mut bind = context.bind.clone();
    bind.retain(|said| {
        let inputs = document.inputs.iter().map(|input| &input.name);
        let mut border = inputs.chain(document.outputs.iter().map(|output| &output.name));
        let is_border = border.any(|name| name.as_str() == said.name.as_str());
        (is_border || at.find_scene(said.name).is_some()) && !own(said.name)
    });
    let set_here = |name: &str| entry.set.iter().any(|(own, _)| **own == *name);
    let mut set = context.set.clone();
    set.retain(|said| {
        let mut params = document.params.iter();
        params.any(|param| param.name.value == **said.name) && !set_here(said.name)
    });
    (bind, set)
}

impl<'e> Overrides<'e> {
    /// The settings of an include itself stand before those of groups.
    pub fn new(entry: &'e Entry, (bind, set): &Said<'e>, position: Position) -> Self {
        let own_bind = entry
            .bind
            .iter()
            .map(|(name, value)| (name, value, position));
        let own_set = entry
            .set
            .iter()
            .map(|(name, value)| (name, value, position));
        let bind = bind
            .iter()
            .map(|said| (said.name, said.value, said.position));
        let set = set
            .iter()
            .map(|said| (said.name, said.value, said.position));
        Self {
            bind: own_bind.chain(bind).collect(),
            set: own_set.chain(set).collect(),
        }
    }
}

/// The params of an included document.
pub(super) fn params(
    entry: &Entry,
    include: &Include,
    document: &Document,
    said: &Overrides<'_>,
    at: &mut At<'_, '_>,
) -> Params {
    let mut set: BTreeMap<String, SetParam> = BTreeMap::new();
    for (name, expr, place) in &said.set {
        let mut params = document.params.iter();
        if !params.any(|param| param.name.value == name.value) {
            let known = document.params.iter().map(|param| param.name.value.clone());
            let known = at.reports().known(known);
            at.report(InterfaceError::Unused {
                document: document.file.name.to_string(),
                name: (*name).clone(),
                known,
            });
            continue;
        }
        let params = &at.symbols().scopes.document(place.scope).params;
        let value = match params.forwarded(expr) {
            Some(value) => value,
            None => eval::value(expr, &mut at.elsewhere(*place)),
        };
        let given = SetParam {
            roots: at.symbols().roots(place.scope, expr),
            expr: Located::new((*expr).clone(), expr.span.clone()),
            value,
        };
        set.insert(name.value.clone(), given);
    }
    values_asked(include, document, &mut set, at);
    let outer = Arc::clone(&at.instance().params);
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
        context: at.symbols().request.surroundings(),
    };
    given.bind(document, &set, at.reports())
}

/// Params without a default that the include does not set are filled by values of that name.
fn values_asked(
    include: &Include,
    document: &Document,
    set: &mut BTreeMap<String, SetParam>,
    at: &mut At<'_, '_>,
) {
    for param in &document.params {
        let name = &param.name.value;
        let is_asked = param.default.is_none()
            && !set.contains_key(name)
            && include.expose.iter().all(|exposed| **exposed != *name);
        let outer = &at.instance().params;
        if !is_asked || outer.bound(name).is_some() {
            continue;
        }
        let Some(id) = at.symbols().scopes.find_value(at.position.scope, name) else {
            continue;
        };
        let span = include.graph.span.clone();
        let expr = Expr::new(ExprKind::Param(name.clone()), span.clone());
        let given = SetParam {
            roots: at.symbols().roots(at.position.scope, &expr),
            value: at.value(id),
            expr: Located::new(expr, span),
        };
        set.insert(name.clone(), given);
    }
}

/// Returns the bindings of an include besides inputs: outputs, which are written into a
/// material here, and names of the scene.
pub(super) fn outside(
    entry: &Entry,
    document: &Document,
    said: &Overrides<'_>,
    (position, has_namespace): (Position, bool),
    at: &mut At<'_, '_>,
) -> (BTreeMap<String, Reported<Target>>, BTreeMap<String, Bound>) {
    let (mut scene, mut overrides) = (BTreeMap::new(), BTreeMap::new());
    for (name, reference, place) in &said.bind {
        if has_input(document, name.as_str()) {
            continue;
        }
        let mut outputs = document.outputs.iter();
        let output = outputs.find(|output| output.name.as_str() == name.as_str());
        if output.is_none() && at.find_scene(name).is_none() {
            let inputs = document.inputs.iter().map(|input| &input.name.value);
            let outputs = document.outputs.iter().map(|output| &output.name.value);
            let known = inputs.chain(outputs).map(ToString::to_string);
            let known = at.reports().known(known);
            at.report(InterfaceError::Unused {
                document: document.file.name.to_string(),
                name: (*name).clone(),
                known,
            });
            continue;
        }
        let target = at.elsewhere(*place).resolve(reference);
        match output {
            None => drop(scene.insert(name.value.clone(), target)),
            Some(output) => {
                let key = output.material.path();
                overrides.insert(key, ((*name).clone(), target));
            }
        }
    }
    for (output, bound) in passed_on(entry, document, (position, has_namespace), at.instance()) {
        overrides.insert(output.material.path(), bound);
    }
    (scene, overrides)
}

/// Returns the outputs of an include that the document around it passes on. The include writes
/// such an output into the material that the document's own output was bound to.
fn passed_on<'d>(
    entry: &Entry,
    document: &'d Document,
    (position, has_namespace): (Position, bool),
    context: &Instance,
) -> Vec<(&'d Output, Bound)> {
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
pub(super) fn overridden(material: &Material, at: &mut At<'_, '_>) -> Option<Reported<Target>> {
    let overrides = &at.instance().overrides;
    let (name, target) = overrides.get(material.name().as_str())?.clone();
    Some(target.and_then(|target| {
        let found = &at.symbols().get(target.id).kind;
        let fits = matches!(
            (material, found),
            (Material::Texture(_), ResourceKind::Texture(_))
                | (Material::Buffer(_), ResourceKind::Buffer(_))
                | (Material::Sampler(_), ResourceKind::Sampler(_))
        );
        if fits {
            return Ok(target);
        }
        let why = format!("this is {}", found.describe());
        Err(at.report(InterfaceError::BoundOutput {
            name,
            why,
            declared: material.name().span.clone(),
        }))
    }))
}

/// The target that an include gives to an input of its document.
pub(super) fn input(
    input: &Input,
    document: &Document,
    include: &Include,
    said: &Overrides<'_>,
    at: &mut At<'_, '_>,
) -> Reported<Target> {
    let name = &input.name.value;
    let bound = said
        .bind
        .iter()
        .find(|(bound, ..)| bound.as_str() == name.as_str());
    let (target, span) = match bound {
        Some((_, reference, place)) => {
            let target = at.elsewhere(*place).resolve(reference)?;
            (target, reference.span.clone())
        }
        None => {
            let span = include.graph.span.clone();
            if at.symbols().scopes.find(at.position.scope, name).is_none() {
                if let Some(reported) = at.instance().incomplete {
                    return Err(reported);
                }
                let known = at.symbols().scopes.known(at.position.scope);
                let known = at.reports().known(known);
                return Err(at.report(InterfaceError::NoInput {
                    document: document.file.name.to_string(),
                    name: input.name.value.to_string(),
                    kind: input.kind.describe_with_format(),
                    span: include.graph.span.clone(),
                    declared: input.name.span.clone(),
                    known,
                }));
            }
            let reference = Reference::new(Located::new(name.clone(), span.clone()));
            let target = at.resolve(&reference)?;
            (target, span)
        }
    };
    let found = &at.symbols().get(target.id).kind;
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
    Err(at.report(InterfaceError::WrongInput {
        document: document.file.name.to_string(),
        name: name.to_string(),
        expected: input.kind.describe_with_format(),
        found,
        span,
        declared: input.name.span.clone(),
    }))
}

/// Returns the names that a document gives, and every output with its target, to be compared
/// with the writes.
pub(super) fn outputs(
    document: &Document,
    said: &Overrides<'_>,
    plan_inputs: &mut PlanInputs,
    at: &mut At<'_, '_>,
) -> (Names, Vec<(Located<Name>, Target)>) {
    let (mut names, mut outputs) = (Names::new(), Vec::new());
    for output in &document.outputs {
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
        let value = at.symbols().scopes.find_value(at.position.scope, &path);
        if let Some(id) = value {
            names.insert(name.value.clone(), Symbol::Value(id));
            continue;
        }
        let target = at.resolve(&output.material);
        if let Ok(target) = &target {
            outputs.push((name.clone(), target.clone()));
        }
        // A bound output has its name here already.
        let is_input = has_input(document, &path);
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
