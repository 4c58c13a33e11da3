//! A document is called as a shader is: inputs and params by name or by what the include says,
//! outputs come back.

use super::{
    build::{Around, Builder},
    flat::Border,
    frames::{Instance, InstanceId, Meaning, Names, Outer, Place},
    params::{Given, Params},
};
use crate::{
    diagnostics::reports::Reported,
    document::{
        materials::{Input, InputKind, Material},
        typed::{Document, Entry, Include, Output},
    },
    errors::instantiate::BorderError,
    language::{
        name::Name,
        syntax::{Expr, Reference},
        value::Value,
    },
    resource::{ResourceKind, Target},
    source::span::Located,
};
use std::{collections::BTreeMap, sync::Arc};

/// A material here that an output is written into, with the place that says so.
type Bound = (Located<String>, Result<Target, Reported>);

/// What an include says of names of its document, its own words first.
struct Said<'e> {
    bind: Vec<(&'e Located<String>, &'e Reference, Place)>,
    set: Vec<(&'e Located<String>, &'e Expr, Place)>,
}

impl<'a> Builder<'a, '_> {
    /// The names that one instance of an include gives; where it has no name of its own and is not
    /// repeated, they are declared here.
    pub fn include(
        &mut self,
        entry: &'a Entry,
        include: &'a Include,
        place: Place,
        around: &Around<'a>,
    ) -> Result<Names, Reported> {
        let document = match &include.document {
            Some(Ok(document)) => document,
            Some(Err(reported)) => {
                let instance = self.world.frames.instance_of(place.frame);
                self.world.frames.instance_mut(instance).incomplete = Some(*reported);
                return Err(*reported);
            }
            None => return Ok(Names::new()),
        };
        self.require(document);
        let said = self.said(entry, document, place, around);
        let has_namespace = include.is_named || place.index.is_some();
        let outer = Outer {
            frame: place.frame,
            namespace: has_namespace.then(|| {
                let suffix = place
                    .index
                    .map_or(String::new(), |index| format!("[{index}]"));
                format!("{}{suffix}.", entry.name.value)
            }),
            private: around.prefix.clone(),
        };
        let params = self.params(entry, include, document, &said, place);
        let (scene, overrides) = self.outside(entry, document, &said, place, has_namespace);
        let instance = self.world.frames.add_instance(Instance {
            document: Arc::clone(document),
            params: Arc::new(params),
            scene,
            outer: Some(outer),
            overrides,
            incomplete: None,
        });
        let frame = self
            .world
            .frames
            .add_frame(instance, None, String::new(), None);
        let mut read_only = Vec::new();
        for input in &document.inputs {
            let target = self.input(input, document, include, &said, place);
            if let Ok(target) = &target {
                let is_output = document
                    .outputs
                    .iter()
                    .any(|output| output.material.path() == *input.name.as_str());
                if !is_output {
                    read_only.push((input.name.clone(), target.clone()));
                }
            }
            let meaning = target.map_or_else(Meaning::Broken, Meaning::Target);
            self.world.frames.declare(frame, &input.name.value, meaning);
        }
        let inner = around.inside(frame);
        self.document(document, &inner);
        let (names, outputs) = self.outputs(document, &said, Place { frame, index: None });
        self.borders.push(Border {
            instance,
            outputs,
            read_only,
        });
        self.give(entry, document, &names, (place, has_namespace))?;
        Ok(names)
    }

    /// Makes what an include gives known where it stands.
    fn give(
        &mut self,
        entry: &Entry,
        document: &Document,
        names: &Names,
        (place, has_namespace): (Place, bool),
    ) -> Result<(), Reported> {
        let frames = &mut self.world.frames;
        let name = &entry.name.value;
        if let Some(reported) = document.broken_outputs {
            let around = frames.instance_of(place.frame);
            frames.instance_mut(around).incomplete = Some(reported);
            if has_namespace {
                frames.declare(place.frame, name, Meaning::Broken(reported));
            }
            return Err(reported);
        }
        if has_namespace && place.index.is_none() {
            frames.declare(place.frame, name, Meaning::Namespace(names.clone()));
        } else if !has_namespace {
            for (name, meaning) in names {
                frames.declare(place.frame, name, meaning.clone());
            }
        }
        Ok(())
    }

    /// What an include says, and groups around it of names that its document asks for.
    fn said<'e>(
        &mut self,
        entry: &'e Entry,
        document: &Document,
        place: Place,
        around: &Around<'e>,
    ) -> Said<'e>
    where
        'a: 'e,
        'e: 'a,
    {
        let own = |name: &str| entry.bind.iter().any(|(own, _)| **own == *name);
        let frame = place.frame;
        let mut inherited = around.bind.clone();
        inherited.retain(|said| {
            let is_border = document
                .inputs
                .iter()
                .any(|input| input.name.as_str() == said.name.as_str())
                || document
                    .outputs
                    .iter()
                    .any(|output| output.name.as_str() == said.name.as_str());
            let asks = is_border || self.world.find_scene(said.name, frame).is_some();
            asks && !own(said.name)
        });
        let set_here = |name: &str| entry.set.iter().any(|(own, _)| **own == *name);
        let mut set = around.set.clone();
        set.retain(|said| {
            let asks = document
                .params
                .iter()
                .any(|param| param.name.value == **said.name);
            asks && !set_here(said.name)
        });
        self.mark(&inherited, &set);
        let bind = entry.bind.iter().map(|(name, value)| (name, value, place));
        let values = entry.set.iter().map(|(name, value)| (name, value, place));
        Said {
            bind: bind
                .chain(
                    inherited
                        .iter()
                        .map(|said| (said.name, said.value, said.place)),
                )
                .collect(),
            set: values
                .chain(set.iter().map(|said| (said.name, said.value, said.place)))
                .collect(),
        }
    }

    fn params(
        &mut self,
        entry: &Entry,
        include: &Include,
        document: &Document,
        said: &Said<'_>,
        place: Place,
    ) -> Params {
        let mut set: BTreeMap<String, (Located<Expr>, Result<Value, Reported>)> = BTreeMap::new();
        for (name, expr, at) in &said.set {
            if !document
                .params
                .iter()
                .any(|param| param.name.value == name.value)
            {
                let known = document.params.iter().map(|param| param.name.value.clone());
                let known = self.reports.known(known);
                self.reports.report(BorderError::Unasked {
                    document: document.file.name.to_string(),
                    name: (*name).clone(),
                    known,
                });
                continue;
            }
            let params = &self.world.frames.document(at.frame).params;
            let value = match params.forwarded(expr) {
                Some(value) => value,
                None => expr.value(&mut self.world.at(*at, None, self.reports)),
            };
            let expr = Located::new((*expr).clone(), expr.span.clone());
            set.insert(name.value.clone(), (expr, value));
        }
        let outer = Arc::clone(&self.world.frames.document(place.frame).params);
        let exposed = include.expose.iter().map(|name| {
            let own = match include.is_named {
                true => format!("{}.{}", entry.name.value, **name),
                false => name.value.clone(),
            };
            (name.as_str(), own)
        });
        let given = Given {
            exposed: exposed.collect(),
            outer: &outer,
            span: &include.graph.span,
            around: self.world.request.surroundings(),
        };
        given.bind(document, &set, self.reports)
    }

    /// What an include binds besides inputs: outputs, which are written into a material here, and
    /// names of the scene.
    fn outside(
        &mut self,
        entry: &Entry,
        document: &Document,
        said: &Said<'_>,
        place: Place,
        has_namespace: bool,
    ) -> (
        BTreeMap<String, Result<Target, Reported>>,
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
            if output.is_none() && self.world.find_scene(name, place.frame).is_none() {
                let known = document
                    .inputs
                    .iter()
                    .map(|input| input.name.value.to_string());
                let outputs = document
                    .outputs
                    .iter()
                    .map(|output| output.name.value.to_string());
                let known = self.reports.known(known.chain(outputs));
                self.reports.report(BorderError::Unasked {
                    document: document.file.name.to_string(),
                    name: (*name).clone(),
                    known,
                });
                continue;
            }
            let target = self.world.resolve(reference, *at, self.reports);
            match output {
                None => drop(scene.insert(name.value.clone(), target)),
                Some(output) => {
                    let key = output.material.path();
                    overrides.insert(key, ((*name).clone(), target));
                }
            }
        }
        for (output, bound) in self.passed_on(entry, document, place, has_namespace) {
            overrides.insert(output.material.path(), bound);
        }
        (scene, overrides)
    }

    /// What the includer of the document around says of what an include gives: where that passes on
    /// an output, it is written into the material that its own was bound to.
    fn passed_on<'d>(
        &self,
        entry: &Entry,
        document: &'d Document,
        place: Place,
        has_namespace: bool,
    ) -> Vec<(&'d Output, Bound)> {
        let around = self.world.frames.document(place.frame);
        let known = |name: &Name| match (has_namespace, place.index) {
            (false, _) => Some(name.to_string()),
            (true, None) => Some(format!("{}.{name}", entry.name.value)),
            (true, Some(_)) => None,
        };
        let passed_on = document.outputs.iter().filter_map(|output| {
            let name = &output.name.value;
            let own = entry.bind.iter().any(|(bound, _)| **bound == **name);
            let bound = around.overrides.get(&known(name)?).filter(|_| !own)?;
            Some((output, bound.clone()))
        });
        passed_on.collect()
    }

    /// The material here that is written instead of one that the document declares.
    pub fn overridden(
        &mut self,
        instance: InstanceId,
        material: &Material,
    ) -> Option<Result<Target, Reported>> {
        let overrides = &self.world.frames.instance(instance).overrides;
        let (name, target) = overrides.get(material.name().as_str())?.clone();
        Some(target.and_then(|target| {
            let found = &self.world.get(target.id).kind;
            let fits = matches!(
                (material, found),
                (Material::Texture(_), ResourceKind::Texture(_))
                    | (Material::Buffer(_), ResourceKind::Buffer(_))
                    | (Material::Sampler(_), ResourceKind::Sampler(_))
            );
            match fits {
                true => Ok(target),
                false => Err(self.reports.report(BorderError::BoundOutput {
                    name,
                    why: format!("this is {}", found.describe()),
                    declared: material.name().span.clone(),
                })),
            }
        }))
    }

    fn input(
        &mut self,
        input: &Input,
        document: &Document,
        include: &Include,
        said: &Said<'_>,
        place: Place,
    ) -> Result<Target, Reported> {
        let name = &input.name.value;
        let bound = said
            .bind
            .iter()
            .find(|(bound, ..)| bound.as_str() == name.as_str());
        let (target, span) = match bound {
            Some((_, reference, at)) => {
                let target = self.world.resolve(reference, *at, self.reports)?;
                (target, reference.span.clone())
            }
            None => {
                let span = include.graph.span.clone();
                if self.world.frames.find(place.frame, name).is_none() {
                    return Err(self.no_input(input, document, include, place));
                }
                let reference = Reference::of(Located::new(name.clone(), span.clone()));
                let target = self.world.resolve(&reference, place, self.reports)?;
                (target, span)
            }
        };
        let found = &self.world.get(target.id).kind;
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
        Err(self.reports.report(BorderError::WrongInput {
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
        place: Place,
    ) -> Reported {
        if let Some(reported) = self.world.frames.document(place.frame).incomplete {
            return reported;
        }
        let known = self.reports.known(self.world.frames.known(place.frame));
        self.reports.report(BorderError::NoInput {
            document: document.file.name.to_string(),
            name: input.name.value.to_string(),
            kind: input.kind.describe_with_format(),
            span: include.graph.span.clone(),
            declared: input.name.span.clone(),
            known,
        })
    }

    /// What a document gives, by name; and every output with what it is, to be held against what is
    /// written.
    fn outputs(
        &mut self,
        document: &Document,
        said: &Said<'_>,
        place: Place,
    ) -> (Names, Vec<(Located<Name>, Target)>) {
        let (mut names, mut outputs) = (Names::new(), Vec::new());
        for output in &document.outputs {
            let name = &output.name;
            match self.is_there(output.condition.as_ref(), place.frame) {
                Ok(true) => {}
                Ok(false) => continue,
                Err(reported) => {
                    names.insert(name.value.clone(), Meaning::Broken(reported));
                    continue;
                }
            }
            let target = self.world.resolve(&output.material, place, self.reports);
            if let Ok(target) = &target {
                outputs.push((name.clone(), target.clone()));
            }
            // What is bound has its name here already.
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
                let meaning = target.map_or_else(Meaning::Broken, Meaning::Target);
                names.insert(name.value.clone(), meaning);
            }
        }
        (names, outputs)
    }
}
