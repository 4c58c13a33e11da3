//! Resources of a plan, and how references of its documents find them.

use super::{
    frames::{FrameId, Frames, Meaning, Place},
    state::{Declared, State},
};
use crate::{
    diagnostics::reports::{Reported, Reports},
    errors::instantiate::BorderError,
    graph::Graph,
    language::{
        name::wgsl_identifier,
        parser,
        syntax::{Expr, Reference, Segment, Selection},
    },
    provided_kind::ProvidedKind,
    provider::{Provided, ProvidedBinding},
    request::PlanRequest,
    resource::{FRAME, Origin, Resource, ResourceId, ResourceKind, SubresourceRange, Target},
    source::span::{Located, SourceFile},
};
use std::collections::{BTreeMap, HashMap};

/// Everything that names of a graph can mean in one plan.
pub(crate) struct World<'a> {
    pub graph: &'a Graph,
    pub request: &'a PlanRequest<'a>,
    pub frames: Frames,
    pub resources: Vec<Resource>,
    /// Of each resource: whether its size is known.
    pub(super) states: Vec<State>,
    /// The materials whose sizes are being found, each for the sake of the one before.
    pub(super) evaluating: Vec<ResourceId>,
    /// Resources of the scene that were named so far.
    scene: HashMap<String, ResourceId>,
    /// How shaders spell the names of the scene.
    spelt: HashMap<String, String>,
    /// Last frame's versions, by the resource that they are versions of.
    previous: BTreeMap<ResourceId, ResourceId>,
}

impl<'a> World<'a> {
    pub fn new(graph: &'a Graph, request: &'a PlanRequest<'a>) -> Self {
        let names = request
            .provider
            .names()
            .into_iter()
            .chain([FRAME.to_owned()]);
        Self {
            graph,
            request,
            frames: Frames::default(),
            resources: Vec::new(),
            states: Vec::new(),
            evaluating: Vec::new(),
            scene: HashMap::new(),
            spelt: names.map(|name| (wgsl_identifier(&name), name)).collect(),
            previous: BTreeMap::new(),
        }
    }

    /// The resource of a number.
    pub fn id(&self, number: usize) -> ResourceId {
        ResourceId(number)
    }

    pub fn get(&self, id: ResourceId) -> &Resource {
        &self.resources[id.0]
    }

    /// Adds a resource whose size is known.
    pub fn add(&mut self, resource: Resource) -> ResourceId {
        self.resources.push(resource);
        self.states.push(State::Known);
        ResourceId(self.resources.len() - 1)
    }

    /// Adds a material whose size is found when somebody asks for it.
    pub(super) fn declare(&mut self, name: String, declared: Declared) -> ResourceId {
        self.resources.push(Resource {
            name,
            declared: Some(declared.span.clone()),
            kind: ResourceKind::Buffer(crate::resource::Buffer::default()),
            origin: Origin::Own,
        });
        self.states.push(State::Declared(declared));
        ResourceId(self.resources.len() - 1)
    }

    /// A buffer whose number of items was asked for and is not known.
    pub(super) fn mark_broken(&mut self, id: ResourceId, reported: Reported) {
        if matches!(self.get(id).kind, ResourceKind::Buffer(_)) {
            self.states[id.0] = State::Broken(reported);
        }
    }

    /// All of a resource.
    pub fn whole(&self, id: ResourceId) -> Target {
        let part = match &self.get(id).kind {
            ResourceKind::Texture(texture) => texture.whole(),
            _ => SubresourceRange::WHOLE,
        };
        Target { id, part }
    }

    /// What a reference of a document names.
    pub fn resolve(
        &mut self,
        reference: &Reference,
        place: Place,
        reports: &mut Reports,
    ) -> Result<Target, Reported> {
        let (mut target, selection) = self.named(reference, place, reports)?;
        self.settle(target.id, reports)?;
        // A part of an input is a part of what is bound to it; a whole one is known only now.
        if target.part == SubresourceRange::WHOLE {
            target = self.whole(target.id);
        }
        // Mips first: of a 3D texture they have fewer slices.
        if let Some(mips) = &reference.mips {
            self.select_mips(&mut target, mips, reference, place, reports)?;
        }
        if let Some(selection) = selection {
            self.select_layers(&mut target, selection, reference, place, reports)?;
        }
        if reference.previous {
            let id = self.previous(target.id);
            target.id = id.map_err(|what| {
                reports.report(BorderError::NoPrevious {
                    name: reference.text().to_owned(),
                    span: reference.span.clone(),
                    what,
                })
            })?;
        }
        Ok(target)
    }

    /// What the names of a reference stand for, and the selection behind the last of them.
    fn named<'r>(
        &mut self,
        reference: &'r Reference,
        place: Place,
        reports: &mut Reports,
    ) -> Result<(Target, Option<&'r Selection>), Reported> {
        let first = &reference.segments[0];
        let Some(meaning) = self.frames.find(place.frame, &first.name.value).cloned() else {
            return self.of_scene(reference, place, reports);
        };
        let mut meaning = meaning;
        let mut walked = first.name.value.to_string();
        let mut segments = reference.segments.iter().peekable();
        while let Some(segment) = segments.next() {
            let names = match meaning {
                Meaning::Broken(reported) => return Err(reported),
                Meaning::Target(target) => {
                    return match segments.peek() {
                        None => Ok((target, segment.selection.as_ref())),
                        Some(next) => Err(reports.report(BorderError::NotOfMaterial {
                            of: walked,
                            name: Located::new(next.name.value.to_string(), next.name.span.clone()),
                        })),
                    };
                }
                Meaning::Namespace(names) => names,
                Meaning::Repeated(list) => {
                    let index = self.repetition(segment, list.len(), place, reports)?;
                    list.into_iter().nth(index).unwrap_or_default()
                }
            };
            let Some(next) = segments.peek() else {
                let name = Located::new(walked, segment.name.span.clone());
                return Err(reports.report(BorderError::Namespace(name)));
            };
            let Some(found) = names.get(&next.name.value) else {
                let known = reports.known(names.keys().map(|name| name.to_string()));
                return Err(self.private(&walked, &next.name, known, reports));
            };
            walked = format!("{walked}.{}", next.name.value);
            meaning = found.clone();
        }
        Err(self.unknown(reference, place, reports))
    }

    fn private(
        &self,
        entry: &str,
        name: &Located<crate::language::name::Name>,
        known: Vec<String>,
        reports: &mut Reports,
    ) -> Reported {
        reports.report(BorderError::Private {
            entry: entry.to_owned(),
            name: Located::new(name.value.to_string(), name.span.clone()),
            known,
        })
    }

    /// Which repetition a segment selects.
    fn repetition(
        &mut self,
        segment: &Segment,
        count: usize,
        place: Place,
        reports: &mut Reports,
    ) -> Result<usize, Reported> {
        let name = &segment.name;
        let Some(Selection::One(expr)) = &segment.selection else {
            let name = Located::new(name.value.to_string(), name.span.clone());
            return Err(reports.report(BorderError::Namespace(name)));
        };
        let index = expr.count(&mut self.at(place, None, reports))?;
        let index = usize::try_from(index).ok().filter(|index| *index < count);
        index.ok_or_else(|| {
            reports.report(BorderError::Range {
                text: format!("{}[{}]", name.value, expr.text()),
                span: expr.span.clone(),
                what: format!("it is repeated {count} times, counted from 0"),
                declared: None,
            })
        })
    }

    /// What a reference names of the scene.
    fn of_scene<'r>(
        &mut self,
        reference: &'r Reference,
        place: Place,
        reports: &mut Reports,
    ) -> Result<(Target, Option<&'r Selection>), Reported> {
        let path = reference.path();
        let (last, others) = match reference.segments.split_last() {
            Some((last, others)) => (last.selection.as_ref(), others),
            None => (None, &[][..]),
        };
        let is_plain = others.iter().all(|segment| segment.selection.is_none());
        if let (Some(Selection::One(number)), true) = (last, is_plain)
            && let Some(of_list) = self.of_list(&path, number, reference, place, reports)
        {
            return of_list.map(|target| (target, None));
        }
        match self.find_scene(&path, place.frame).filter(|_| is_plain) {
            Some(target) => Ok((target?, last)),
            None => Err(self.unknown(reference, place, reports)),
        }
    }

    /// One of a list whose members have names of their own, such as `lights[1]`: it may be of
    /// another kind than the others. `None` if it is no such list, or an own material stands in.
    fn of_list(
        &mut self,
        list: &str,
        number: &Expr,
        reference: &Reference,
        place: Place,
        reports: &mut Reports,
    ) -> Option<Result<Target, Reported>> {
        let instance = self.frames.instance_of(place.frame);
        if self.frames.scene(instance, list).is_some() {
            return None;
        }
        let provider = self.request.provider;
        provider.describe(&format!("{list}.0"))?;
        let count = provider.describe(list)?.items?;
        let number = match number.count(&mut self.at(place, None, reports)) {
            Ok(number) => number,
            Err(reported) => return Some(Err(reported)),
        };
        let found = self.find_scene(&format!("{list}.{number}"), place.frame);
        Some(found.unwrap_or_else(|| {
            Err(reports.report(BorderError::Range {
                text: reference.text().to_owned(),
                span: reference.span.clone(),
                what: format!("there are {count} of them, counted from 0; this is [{number}]"),
                declared: None,
            }))
        }))
    }

    /// What a name of the scene stands for in a frame.
    pub fn find_scene(&mut self, name: &str, frame: FrameId) -> Option<Result<Target, Reported>> {
        let instance = self.frames.instance_of(frame);
        if let Some(bound) = self.frames.scene(instance, name) {
            return Some(bound);
        }
        let id = match self.scene.get(name) {
            Some(id) => *id,
            None => {
                let kind = match self.request.provider.describe(name) {
                    Some(Provided {
                        binding: ProvidedBinding::AccelerationStructure,
                        ..
                    }) => ResourceKind::AccelerationStructure,
                    Some(provided) => ResourceKind::Provided(provided),
                    None if name == FRAME => ResourceKind::Frame,
                    None => return None,
                };
                let id = self.add(Resource {
                    name: name.to_owned(),
                    declared: None,
                    kind,
                    origin: Origin::Host,
                });
                self.scene.insert(name.to_owned(), id);
                id
            }
        };
        Some(Ok(self.whole(id)))
    }

    /// The kind of what a name of the scene stands for in a frame. A document's own material that
    /// stands in for it is of the first kind.
    pub fn provided_kind(&mut self, name: &str, frame: FrameId) -> Option<ProvidedKind> {
        let target = self.find_scene(name, frame)?.ok()?;
        if let ResourceKind::Provided(provided) = &self.get(target.id).kind {
            return provided.kind;
        }
        let kind = self.request.provider.describe(name)?.kind?;
        Some(ProvidedKind { number: 0, ..kind })
    }

    /// The kind that a shader asks for by an overridable constant of that name: `light_kind`.
    pub fn kind_spelt(&mut self, constant: &str, frame: FrameId) -> Option<ProvidedKind> {
        let name = self.spelt.get(constant.strip_suffix("_kind")?)?.clone();
        self.provided_kind(&name, frame)
    }

    /// What a shader's global of that name stands for in a frame.
    pub fn find_global(
        &mut self,
        global: &str,
        frame: FrameId,
        reports: &mut Reports,
    ) -> Option<Result<Target, Reported>> {
        let found = self.frames.find_spelt(frame, global).or_else(|| {
            let name = self.spelt.get(global).cloned()?;
            self.find_scene(&name, frame)
        });
        if let Some(found) = found {
            return Some(found.and_then(|target| {
                self.settle(target.id, reports)?;
                Ok(match target.part == SubresourceRange::WHOLE {
                    true => self.whole(target.id),
                    false => target,
                })
            }));
        }
        let base = self.find_global(global.strip_suffix("_previous")?, frame, reports)?;
        let previous = base.map(|base| {
            let id = self.previous(base.id).ok()?;
            Some(Target { id, ..base })
        });
        previous.transpose()
    }

    /// Reports a reference that names nothing.
    fn unknown(&self, reference: &Reference, place: Place, reports: &mut Reports) -> Reported {
        let instance = self.frames.document(place.frame);
        if let Some(reported) = instance.incomplete {
            return reported;
        }
        let known = reports.known(self.known(place.frame));
        reports.report(BorderError::Unknown {
            name: Located::new(reference.path(), reference.span.clone()),
            document: instance.document.file.name.to_string(),
            known,
        })
    }

    /// The place of the root document's own expressions.
    pub fn root(&self) -> Place {
        Place {
            frame: self.frames.root(),
            index: None,
        }
    }

    /// What a command calls so: a resource by its full name, or a part of what the root document
    /// knows. `None` if nothing is called so.
    pub fn find_full(
        &mut self,
        name: &str,
        reports: &mut Reports,
    ) -> Option<Result<Target, Reported>> {
        let known = self
            .resources
            .iter()
            .position(|resource| resource.name == name);
        if let Some(number) = known {
            let id = ResourceId(number);
            return Some(self.settle(id, reports).map(|()| self.whole(id)));
        }
        // A file of its own, so that mistakes in it are told as those of a command.
        let file = SourceFile::new("command line", name);
        let reference = parser::reference(&file, 0..name.len()).ok()?;
        let mut unheard = Reports::default();
        self.resolve(&reference, self.root(), &mut unheard)
            .ok()
            .map(Ok)
    }

    /// Full names of all resources, and of what the scene has besides.
    pub fn full_names(&self) -> Vec<String> {
        let mut names: Vec<String> = self.resources.iter().map(|r| r.name.clone()).collect();
        names.sort();
        let scene = self.request.provider.names();
        names.extend(
            scene
                .into_iter()
                .filter(|name| !self.scene.contains_key(name)),
        );
        names
    }

    /// Every name that is known in a frame, its document's first.
    pub fn known(&self, frame: FrameId) -> Vec<String> {
        let mut known = self.frames.known(frame);
        known.extend(self.request.provider.names());
        known
    }

    /// The resource that is last frame's version of another one; what that one is if there is none.
    fn previous(&mut self, base: ResourceId) -> Result<ResourceId, String> {
        if let Some(id) = self.previous.get(&base) {
            return Ok(*id);
        }
        let resource = self.get(base);
        let what = match (&resource.kind, resource.origin) {
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

    /// The resource whose layout and size a resource has: itself, or what it is last frame's
    /// version of.
    pub fn base(&self, id: ResourceId) -> ResourceId {
        match self.get(id).origin {
            Origin::Previous(base) => base,
            _ => id,
        }
    }

    /// Gives last frame's versions the sizes of what they are versions of.
    pub fn size_previous(&mut self) {
        for (base, previous) in &self.previous {
            self.resources[previous.0].kind = self.resources[base.0].kind.clone();
        }
    }
}
