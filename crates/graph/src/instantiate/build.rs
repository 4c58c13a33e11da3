//! Walks the entries of documents: conditions, repetitions, groups.

use super::{
    flat::{Border, Deciding, Flat, FlatPass, Inherited, Run},
    frames::{FrameId, Instance, InstanceId, Meaning, Names, Place},
    params::Params,
    state::Declared,
    world::World,
};
use crate::{
    diagnostics::reports::{Reported, Reports},
    document::{
        materials::{Input, InputKind},
        raw::Broken,
        typed::{Document, Entry, Run as RunEntry, What},
    },
    errors::instantiate::BorderError,
    graph::Graph,
    language::{
        name::Name,
        syntax::{Expr, Leaf, Reference},
    },
    provider::Import,
    request::PlanRequest,
    resource::{Buffer, Origin, Resource, ResourceKind, Sampler, Texture},
    source::span::Located,
};
use std::{collections::BTreeMap, sync::Arc};

/// Most passes (groups and includes among them), and most materials, of a graph. A guard against
/// documents that double with each include: what is above takes memory and time that nobody means
/// to spend.
const MOST: usize = 16_384;

/// What is around an entry.
#[derive(Clone)]
pub(super) struct Around<'a> {
    pub frame: FrameId,
    /// What names of passes begin with.
    pub prefix: String,
    run: Option<(Run, bool)>,
    pub bind: Vec<Inherited<'a, Reference>>,
    pub set: Vec<Inherited<'a, Expr>>,
}

impl<'a> Around<'a> {
    fn new(frame: FrameId) -> Self {
        Self {
            frame,
            prefix: String::new(),
            run: None,
            bind: Vec::new(),
            set: Vec::new(),
        }
    }

    /// What is around the entries of an included document: nothing that groups outside say of
    /// names, for these are not its own.
    pub fn inside(&self, frame: FrameId) -> Self {
        Self {
            prefix: self.prefix.clone(),
            run: self.run.clone(),
            ..Self::new(frame)
        }
    }
}

pub(super) struct Builder<'a, 'r> {
    pub world: World<'a>,
    passes: Vec<FlatPass<'a>>,
    first_broken: Option<usize>,
    pub borders: Vec<Border>,
    deciding: Deciding,
    /// What groups say, and whether something in them asks for it.
    said: Vec<(&'a Located<Name>, &'a Located<String>, bool)>,
    spent: usize,
    full: Option<Reported>,
    pub reports: &'r mut Reports,
}

/// Flattens a document with all that it includes.
pub(crate) fn flatten<'a>(
    graph: &'a Graph,
    request: &'a PlanRequest<'a>,
    params: Params,
    reports: &mut Reports,
) -> Flat<'a> {
    let mut builder = Builder {
        world: World::new(graph, request),
        passes: Vec::new(),
        first_broken: None,
        borders: Vec::new(),
        deciding: Deciding::default(),
        said: Vec::new(),
        spent: 0,
        full: None,
        reports,
    };
    let document = &graph.document;
    let instance = builder.world.frames.add_instance(Instance {
        document: Arc::clone(document),
        params: Arc::new(params),
        scene: BTreeMap::new(),
        outer: None,
        overrides: BTreeMap::new(),
        incomplete: None,
    });
    let frame = builder
        .world
        .frames
        .add_frame(instance, None, String::new(), None);
    builder.require(document);
    builder.imports(document, frame);
    builder.document(document, &Around::new(frame));
    builder.root_border(document, instance, frame);
    builder.finish()
}

impl<'a> Builder<'a, '_> {
    /// The features that a document cannot do without.
    pub fn require(&mut self, document: &Document) {
        for (feature, flag) in &document.requires {
            if !self.world.request.features.contains(*flag) {
                let error = BorderError::Feature {
                    document: document.file.name.to_string(),
                    feature: feature.clone(),
                };
                // Whoever may not go on is told so by the report.
                let _ = self.reports.beyond(error);
            }
        }
    }

    /// The inputs of the root document are what the host imports.
    fn imports(&mut self, document: &Document, frame: FrameId) {
        for input in &document.inputs {
            let name = &input.name;
            let meaning = match self.import(input) {
                Ok(kind) => {
                    let id = self.world.add(Resource {
                        name: name.value.to_string(),
                        declared: Some(name.span.clone()),
                        kind,
                        origin: Origin::Host,
                    });
                    Meaning::Target(self.world.whole(id))
                }
                Err(error) => Meaning::Broken(self.reports.report(error)),
            };
            self.world.frames.declare(frame, &name.value, meaning);
        }
    }

    fn import(&self, input: &Input) -> Result<ResourceKind, BorderError> {
        let name = Located::new(input.name.value.to_string(), input.name.span.clone());
        let Some(import) = self.world.request.imports.get(&name.value) else {
            return Err(BorderError::NoImport(name));
        };
        let wrong = |expected: &str, found: String| BorderError::WrongImport {
            name: name.clone(),
            expected: expected.to_owned(),
            found,
        };
        match (&input.kind, *import) {
            (InputKind::Texture(asked), Import::Texture { format, .. })
                if asked.is_some_and(|asked| asked != format) =>
            {
                let asked = asked.map_or(String::new(), |asked| format!("a texture {asked:?}"));
                Err(wrong(&asked, format!("a texture {format:?}")))
            }
            (
                InputKind::Texture(_),
                Import::Texture {
                    format,
                    size,
                    mips,
                    layers,
                    is_3d,
                    samples,
                    ..
                },
            ) => Ok(ResourceKind::Texture(Texture {
                format,
                size,
                layers,
                is_3d,
                mips,
                samples,
                picture: None,
            })),
            (InputKind::Buffer, Import::Buffer { bytes, items, .. }) => {
                Ok(ResourceKind::Buffer(Buffer {
                    count: items,
                    bytes,
                    ..Buffer::default()
                }))
            }
            (InputKind::Sampler { compare: asked }, Import::Sampler { filter, compare })
                if *asked == compare =>
            {
                Ok(ResourceKind::Sampler(Sampler {
                    filter,
                    address: Default::default(),
                    compare: compare.then_some(wgt::CompareFunction::LessEqual),
                }))
            }
            (kind, import) => Err(wrong(kind.describe(), import.describe().to_owned())),
        }
    }

    /// The materials and entries of a document.
    pub fn document(&mut self, document: &'a Arc<Document>, around: &Around<'a>) {
        let frame = around.frame;
        for (name, reported) in &document.broken_materials {
            match Name::new(name) {
                Ok(name) => {
                    let meaning = Meaning::Broken(*reported);
                    self.world.frames.declare(frame, &name, meaning);
                }
                Err(_) => self.incomplete(frame, *reported),
            }
        }
        if let Some(reported) = document.incomplete {
            self.incomplete(frame, reported);
            self.broken();
        }
        for (number, material) in document.materials.iter().enumerate() {
            if self.world.resources.len() >= MOST {
                let name = material.name();
                let at = Located::new(name.value.to_string(), name.span.clone());
                return self.is_full(&at, "materials");
            }
            let name = material.name();
            let instance = self.world.frames.instance_of(frame);
            let meaning = match self.overridden(instance, material) {
                Some(Ok(target)) => Meaning::Target(target),
                Some(Err(reported)) => Meaning::Broken(reported),
                None => {
                    let full = self.world.frames.full_name(instance, &name.value);
                    let declared = Declared {
                        frame,
                        document: Arc::clone(document),
                        number,
                        span: name.span.clone(),
                    };
                    let id = self.world.declare(full, declared);
                    Meaning::Target(self.world.whole(id))
                }
            };
            self.world.frames.declare(frame, &name.value, meaning);
        }
        self.entries(&document.entries, around);
    }

    fn incomplete(&mut self, frame: FrameId, reported: Reported) {
        let instance = self.world.frames.instance_of(frame);
        self.world.frames.instance_mut(instance).incomplete = Some(reported);
    }

    pub(super) fn entries(&mut self, entries: &'a [Result<Entry, Broken>], around: &Around<'a>) {
        for entry in entries {
            match entry {
                Ok(entry) => {
                    if self.entry(entry, around).is_err() {
                        self.broken();
                    }
                }
                Err(broken) => {
                    self.broken();
                    if broken.is_include {
                        self.incomplete(around.frame, broken.reported);
                    }
                }
            }
        }
    }

    pub fn broken(&mut self) {
        let above = self.passes.len();
        self.first_broken.get_or_insert(above);
    }

    /// Whether an entry or output is there.
    pub fn is_there(&mut self, condition: Option<&Expr>, frame: FrameId) -> Result<bool, Reported> {
        let Some(condition) = condition else {
            return Ok(true);
        };
        let params = &self.world.frames.document(frame).params;
        self.deciding.params.extend(params.roots(condition));
        condition.visit(&mut |leaf| {
            if let Leaf::Has(feature) = leaf {
                self.deciding.features |= feature;
            }
        });
        let place = Place { frame, index: None };
        condition.boolean(&mut self.world.at(place, None, self.reports))
    }

    fn entry(&mut self, entry: &'a Entry, around: &Around<'a>) -> Result<(), Reported> {
        if let Some(reported) = self.full {
            return Err(reported);
        }
        let frame = around.frame;
        if !self.is_there(entry.condition.as_ref(), frame)? {
            return Ok(());
        }
        let place = Place { frame, index: None };
        let count = match &entry.repeat {
            None => 1,
            Some(repeat) => repeat.count32(&mut self.world.at(place, None, self.reports))?,
        };
        self.spent = self.spent.saturating_add(count as usize);
        if self.spent > MOST {
            let at = Located::new(entry.name.value.to_string(), entry.name.span.clone());
            self.is_full(&at, "passes");
        }
        if let Some(reported) = self.full {
            return Err(reported);
        }
        let Some(_) = entry.repeat else {
            return self.instance(entry, None, around).map(drop);
        };
        let mut given = Vec::new();
        let mut wrong = None;
        for index in 0..count {
            match self.instance(entry, Some(index), around) {
                Ok(names) => given.push(names),
                // The others would be wrong in the same way.
                Err(reported) => {
                    wrong = Some(reported);
                    break;
                }
            }
        }
        if !matches!(entry.what, What::Pass(_)) {
            let meaning = wrong.map_or(Meaning::Repeated(given), Meaning::Broken);
            self.world.frames.declare(frame, &entry.name.value, meaning);
        }
        wrong.map_or(Ok(()), Err)
    }

    /// One instance of an entry; returns the names that it gives where it is repeated.
    fn instance(
        &mut self,
        entry: &'a Entry,
        index: Option<u32>,
        around: &Around<'a>,
    ) -> Result<Names, Reported> {
        let suffix = index.map_or(String::new(), |index| format!("[{index}]"));
        let name = format!("{}{}{suffix}", around.prefix, entry.name.value);
        let place = Place {
            frame: around.frame,
            index,
        };
        let run = self.run(entry, place, around)?;
        match &entry.what {
            What::Pass(pass) => {
                let (run, enabled) = run.unwrap_or((Run::Always, true));
                let pass = FlatPass {
                    name: Located::new(name, entry.name.span.clone()),
                    entry,
                    pass,
                    place,
                    run,
                    enabled,
                    bind: self.asked(&around.bind, |name| {
                        self.asks_global(around.frame, entry, name)
                    }),
                    set: self.asked(&around.set, |name| {
                        self.asks_param(around.frame, entry, name)
                    }),
                };
                self.mark(&pass.bind, &pass.set);
                self.passes.push(pass);
                Ok(Names::new())
            }
            What::Group(entries) => {
                let frame = match index {
                    None => around.frame,
                    Some(index) => {
                        let frames = &mut self.world.frames;
                        let path =
                            format!("{}{}[{index}].", frames.path(place.frame), entry.name.value);
                        let instance = frames.instance_of(place.frame);
                        let index = Some((entry.name.value.clone(), index));
                        frames.add_frame(instance, Some(place.frame), path, index)
                    }
                };
                let place = Place { frame, index: None };
                let inner = Around {
                    frame,
                    prefix: format!("{name}."),
                    run,
                    bind: self.say(&entry.bind, place, entry, &around.bind),
                    set: self.say(&entry.set, place, entry, &around.set),
                };
                self.entries(entries, &inner);
                Ok(match index {
                    Some(_) => self.world.frames.names(frame).clone(),
                    None => Names::new(),
                })
            }
            What::Include(include) => {
                let around = Around {
                    prefix: format!("{name}."),
                    run,
                    ..around.clone()
                };
                self.include(entry, include, place, &around)
            }
        }
    }

    /// In which frames an entry runs, and what is in it and does not say otherwise.
    fn run(
        &mut self,
        entry: &Entry,
        place: Place,
        around: &Around<'a>,
    ) -> Result<Option<(Run, bool)>, Reported> {
        let condition = match &entry.run {
            None => return Ok(around.run.clone()),
            Some(RunEntry::Always) => return Ok(Some((Run::Always, true))),
            Some(RunEntry::Once) => return Ok(Some((Run::Once, true))),
            Some(RunEntry::OnChange) => return Ok(Some((Run::OnChange, true))),
            Some(RunEntry::When(condition)) => condition,
        };
        let enabled = condition.boolean(&mut self.world.at(place, None, self.reports))?;
        let instance = self.world.frames.document(place.frame);
        let params = Arc::clone(&instance.params);
        let outer = instance.outer.as_ref();
        let private = outer.map_or(String::new(), |outer| outer.private.clone());
        // Conditions of two documents are one if they are made of the same params of the root;
        // attributes (`index` is one) are what they are here.
        let text = condition.canonical(&mut |leaf| match leaf.as_param() {
            Some(name) => match params.bound(name) {
                Some(bound) => match &bound.root {
                    Some(root) => root.clone(),
                    None => format!("{private}{name}"),
                },
                None => name.to_owned(),
            },
            None => {
                let value = leaf.value(&mut self.world.at(place, None, self.reports));
                value.map_or_else(|_| leaf.text().to_owned(), |value| value.to_string())
            }
        });
        Ok(Some((Run::When(text), enabled)))
    }

    /// Adds what a group says to what is said around it; the inner one counts.
    fn say<T>(
        &mut self,
        own: &'a [(Located<String>, T)],
        place: Place,
        group: &'a Entry,
        outer: &[Inherited<'a, T>],
    ) -> Vec<Inherited<'a, T>> {
        let mut said = Vec::new();
        for (name, value) in own {
            let known = self
                .said
                .iter()
                .position(|(_, known, _)| std::ptr::eq(*known, name));
            let number = known.unwrap_or_else(|| {
                self.said.push((&group.name, name, false));
                self.said.len() - 1
            });
            said.push(Inherited {
                name,
                value,
                place,
                number,
            });
        }
        let hidden = |name: &str| own.iter().any(|(own, _)| **own == *name);
        said.extend(outer.iter().copied().filter(|said| !hidden(said.name)));
        said
    }

    /// What groups say that somebody asks for.
    pub fn asked<T>(
        &self,
        said: &[Inherited<'a, T>],
        asks: impl Fn(&str) -> bool,
    ) -> Vec<Inherited<'a, T>> {
        said.iter()
            .copied()
            .filter(|said| asks(said.name))
            .collect()
    }

    /// Notes that something asks for what groups say.
    pub fn mark<T, U>(&mut self, bind: &[Inherited<'_, T>], set: &[Inherited<'_, U>]) {
        let numbers = bind.iter().map(|said| said.number);
        for number in numbers.chain(set.iter().map(|said| said.number)) {
            self.said[number].2 = true;
        }
    }

    /// Whether a shader of a pass has such a global that the pass itself says nothing of.
    fn asks_global(&self, frame: FrameId, entry: &Entry, name: &str) -> bool {
        let said = entry.bind.iter().any(|(own, _)| **own == *name);
        !said
            && self.any_shader(frame, entry, |shader| {
                shader.global_names().any(|n| n == name)
            })
    }

    /// The same of a param or override.
    fn asks_param(&self, frame: FrameId, entry: &Entry, name: &str) -> bool {
        let said = entry.set.iter().any(|(own, _)| **own == *name);
        !said && self.any_shader(frame, entry, |shader| shader.params().any(|n| n == name))
    }

    fn any_shader(
        &self,
        frame: FrameId,
        entry: &Entry,
        asks: impl Fn(&crate::shader::reflect::Shader) -> bool,
    ) -> bool {
        let What::Pass(pass) = &entry.what else {
            return false;
        };
        let document = &self.world.frames.document(frame).document;
        let shaders = pass.shaders.iter();
        let mut shaders = shaders.filter_map(|name| self.world.graph.shaders.get(document, name));
        // One with a mistake may ask for anything.
        shaders.any(|shader| shader.as_ref().map_or(true, |shader| asks(shader)))
    }

    /// Says once that there is no room for more.
    fn is_full(&mut self, name: &Located<String>, what: &'static str) {
        self.broken();
        if self.full.is_none() {
            self.full = Some(self.reports.report(BorderError::TooMany {
                most: MOST,
                what,
                at: name.span.clone(),
            }));
        }
    }

    /// Every size is found, every full name noted.
    fn finish(mut self) -> Flat<'a> {
        let mut number = 0;
        // Finding one may add others.
        while number < self.world.resources.len() {
            let id = self.world.id(number);
            // Who names one that is broken is told so by what it gets instead.
            let _ = self.world.settle(id, self.reports);
            number += 1;
        }
        for (group, name, is_asked) in std::mem::take(&mut self.said) {
            if !is_asked && self.first_broken.is_none() {
                self.reports.report(BorderError::UnaskedInGroup {
                    group: group.value.to_string(),
                    name: name.clone(),
                });
            }
        }
        Flat {
            world: self.world,
            passes: self.passes,
            first_broken: self.first_broken,
            borders: self.borders,
            deciding: self.deciding,
        }
    }

    /// What the root document gives and takes.
    fn root_border(&mut self, document: &Document, instance: InstanceId, frame: FrameId) {
        let mut read_only = Vec::new();
        for input in &document.inputs {
            let is_output = document
                .outputs
                .iter()
                .any(|output| output.material.path() == *input.name.as_str());
            if let (false, Some(Meaning::Target(target))) =
                (is_output, self.world.frames.find(frame, &input.name.value))
            {
                read_only.push((input.name.clone(), target.clone()));
            }
        }
        self.borders.push(Border {
            instance,
            outputs: Vec::new(),
            read_only,
        });
    }
}
