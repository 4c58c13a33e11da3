//! Phase 2: names become resources, sizes become numbers.

mod enter;
mod previous;
mod sizes;

pub(crate) use previous::{previous, previous_of};

use crate::{
    diagnostics::{Code, Diagnostic, HINTED},
    document::{
        located::Located,
        materials::{Count, Material, SamplerEntry},
    },
    instantiate::{PassScope, split_layer},
    provider::{Import, Provided, Provider},
    registry::Params,
    source::Span,
};
use sizes::Sizes;
use std::{
    collections::{BTreeMap, HashMap, HashSet},
    ops::Range,
};

/// Index of a resource in [`Resources`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(crate) struct ResourceId(pub usize);

/// A texture, buffer or sampler that passes may name.
#[derive(Clone, Debug)]
pub(crate) struct Resource {
    pub name: String,
    /// Where it is declared; provided resources and a pass's own buffers are not.
    pub declared: Option<Span>,
    pub kind: ResourceKind,
    pub origin: Origin,
}

/// Whose content a resource holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Origin {
    /// The graph's own, made by its passes in every frame.
    Own,
    /// The host's: an import or a provided resource. It has content before the first pass.
    Host,
    /// What another resource held at the end of the frame before.
    Previous(ResourceId),
}

#[derive(Clone, Debug)]
pub(crate) enum ResourceKind {
    Texture(Texture),
    Buffer(Buffer),
    Sampler(SamplerEntry),
    Provided(Provided),
}

impl ResourceKind {
    pub fn describe(&self) -> &'static str {
        match self {
            Self::Texture(_) => "a texture",
            Self::Buffer(_) => "a buffer",
            Self::Sampler(SamplerEntry {
                compare: Some(_), ..
            }) => "a sampler with `compare`",
            Self::Sampler(_) => "a sampler without `compare`",
            Self::Provided(_) => "a provided buffer",
        }
    }
}

#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Texture {
    pub format: wgpu::TextureFormat,
    pub size: [u32; 2],
    pub mips: u32,
    pub layers: u32,
}

impl Texture {
    pub fn bytes(&self) -> u64 {
        let texel = self
            .format
            .theoretical_memory_footprint(wgpu::Extent3d::default());
        // A host's limits may allow for more than 64 bits can count.
        let mip = |level: u32| {
            let edges = self.size.map(|edge| u64::from((edge >> level).max(1)));
            [edges[0], edges[1], u64::from(self.layers)]
                .into_iter()
                .fold(texel, u64::saturating_mul)
        };
        (0..self.mips).map(mip).fold(0, u64::saturating_add)
    }
}

#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Buffer {
    /// Items of the runtime-sized array, where the document gives them.
    pub count: Option<u64>,
    /// Size, known after linking (item layouts come from WGSL).
    pub bytes: u64,
}

/// Mips and layers of a texture; `0..1`, `0..1` for buffers.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Part {
    pub mips: Range<u32>,
    pub layers: Range<u32>,
}

impl Part {
    pub const ONE: Part = Part {
        mips: 0..1,
        layers: 0..1,
    };

    pub fn overlaps(&self, other: &Part) -> bool {
        let meet = |a: &Range<u32>, b: &Range<u32>| a.start < b.end && b.start < a.end;
        meet(&self.mips, &other.mips) && meet(&self.layers, &other.layers)
    }

    pub fn is_single(&self) -> bool {
        self.mips.len() == 1 && self.layers.len() == 1
    }
}

/// What a name stands for.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Target {
    pub id: ResourceId,
    pub part: Part,
}

/// All resources of a plan, by name.
pub(crate) struct Resources<'a> {
    pub list: Vec<Resource>,
    names: HashMap<String, Target>,
    /// Names as a shader spells them.
    spelt: HashMap<String, String>,
    /// Spellings that two names share, with these.
    ambiguous: HashMap<String, [String; 2]>,
    /// Declared, but with a mistake that was reported; nothing more is said about them.
    broken: HashSet<String>,
    /// What unknown names begin with that are no mistake, because an include that would have brought them has one.
    hidden: Vec<String>,
    /// The scope of the pass that is looked at: what its document calls some of them.
    pub nearby: Option<PassScope>,
    /// Last frame's versions, by the resource that they are versions of.
    previous: HashMap<ResourceId, ResourceId>,
    provider: &'a dyn Provider,
    viewport: [u32; 2],
}

/// What sizes are resolved against.
pub(crate) struct Environment<'a> {
    pub viewport: [u32; 2],
    pub limits: &'a wgpu::Limits,
    pub provider: &'a dyn Provider,
    pub imports: &'a BTreeMap<String, Import>,
}

pub(crate) fn resolve<'a>(
    materials: &[Material],
    unread: &[String],
    params: &Params,
    environment: &Environment<'a>,
    diagnostics: &mut Vec<Diagnostic>,
) -> Resources<'a> {
    let mut resources = Resources {
        list: Vec::new(),
        names: HashMap::new(),
        spelt: HashMap::new(),
        ambiguous: HashMap::new(),
        broken: HashSet::new(),
        hidden: Vec::new(),
        nearby: None,
        previous: HashMap::new(),
        provider: environment.provider,
        viewport: environment.viewport,
    };
    for name in environment.provider.names() {
        resources.spelt.insert(spelling(&name), name);
    }
    unread.iter().for_each(|name| resources.spoil(name));
    resources.add_imports(materials, environment.imports, diagnostics);
    let textures = materials.iter().filter_map(|material| match material {
        Material::Texture(entry) => Some((entry.name.as_str(), entry)),
        _ => None,
    });
    let mut sizes = Sizes {
        textures: textures.collect(),
        params,
        environment,
        done: HashMap::new(),
    };
    // Textures first: buffers may be counted by them.
    for material in materials {
        let name = material.name();
        let declared = Some(name.span.clone());
        match material {
            Material::Texture(entry) => match sizes.texture(entry, diagnostics) {
                Some(texture) => {
                    let id =
                        resources.add(name.value.clone(), declared, ResourceKind::Texture(texture));
                    resources.add_views(entry, id, diagnostics);
                }
                None => {
                    resources.spoil(name);
                    entry
                        .views
                        .iter()
                        .for_each(|view| resources.spoil(&view.name));
                }
            },
            Material::Sampler(entry) => {
                resources.add(
                    name.value.clone(),
                    declared,
                    ResourceKind::Sampler(entry.clone()),
                );
            }
            Material::Buffer(_) => {}
        }
    }
    resources.add_buffers(materials, params, diagnostics);
    resources
}

/// A name as a WGSL identifier.
pub(crate) fn spelling(name: &str) -> String {
    // `cascade[0].depth` is `cascade_0_depth`.
    name.replace(['.', '@', ' ', '['], "_").replace(']', "")
}

fn size_error(name: &Located<String>, span: &Span, what: &str, help: &str) -> Diagnostic {
    Diagnostic::error(Code::Size, format!("`{}`: {what}", name.value))
        .at(span.clone(), "")
        .help(help)
}

impl Resources<'_> {
    /// Adds a resource under its name (and its spelling in WGSL).
    pub fn add(&mut self, name: String, declared: Option<Span>, kind: ResourceKind) -> ResourceId {
        let id = ResourceId(self.list.len());
        let part = match &kind {
            ResourceKind::Texture(texture) => Part {
                mips: 0..texture.mips,
                layers: 0..texture.layers,
            },
            _ => Part::ONE,
        };
        self.names.insert(name.clone(), Target { id, part });
        self.spell(&name);
        let origin = match kind {
            ResourceKind::Provided(_) => Origin::Host,
            _ => Origin::Own,
        };
        self.list.push(Resource {
            name,
            declared,
            kind,
            origin,
        });
        id
    }

    /// Notes how a shader spells a name.
    fn spell(&mut self, name: &str) {
        let spelling = spelling(name);
        let known = self.spelt.insert(spelling.clone(), name.to_owned());
        if let Some(known) = known.filter(|known| known != name) {
            self.ambiguous.insert(spelling, [known, name.to_owned()]);
        }
    }

    /// The two names that a resource's spelling may mean.
    pub fn ambiguous(&self, name: &str) -> Option<&[String; 2]> {
        self.ambiguous.get(&spelling(name))
    }

    /// Marks a name as declared with a mistake.
    fn spoil(&mut self, name: &str) {
        self.broken.insert(name.to_owned());
        self.broken.insert(spelling(name));
    }

    /// Whether a name, or a shader's spelling of one, is that of a material with a mistake that was reported.
    pub fn is_broken(&self, name: &str) -> bool {
        let mut hidden = self.hidden.iter();
        self.broken.contains(name) || hidden.any(|prefix| name.starts_with(prefix))
    }

    /// From here on, unknown names that begin with one of these are not reported.
    pub fn hide(&mut self, prefixes: &[String]) {
        let spelt = prefixes.iter().map(|prefix| spelling(prefix));
        self.hidden.extend(prefixes.iter().cloned().chain(spelt));
    }

    pub fn get(&self, id: ResourceId) -> &Resource {
        &self.list[id.0]
    }

    /// What `name` stands for; a provided resource is entered at its first use.
    pub fn find(&mut self, name: &str) -> Option<Target> {
        if let Some(target) = self.names.get(name) {
            return Some(target.clone());
        }
        if let Some(of) = previous_of(name) {
            return self.find_previous(name, of);
        }
        if let Some(layer) = self.layer(name) {
            return layer;
        }
        let provided = self.provider.describe(name)?;
        let id = self.add(name.to_owned(), None, ResourceKind::Provided(provided));
        Some(Target {
            id,
            part: Part {
                mips: 0..1,
                layers: 0..1,
            },
        })
    }

    /// What `name[N]` stands for: layer N of a texture or view. `Some(None)` if there is such a texture without that layer.
    fn layer(&mut self, name: &str) -> Option<Option<Target>> {
        let (whole, layer) = split_layer(name)?;
        let Target { id, part } = self.find(whole)?;
        if !matches!(self.get(id).kind, ResourceKind::Texture(_)) {
            return None;
        }
        let first = part.layers.start.checked_add(layer);
        let first = first.filter(|first| *first < part.layers.end);
        Some(first.map(|first| Target {
            id,
            part: Part {
                mips: part.mips,
                layers: first..first + 1,
            },
        }))
    }

    /// What a shader global of that name stands for.
    pub fn find_spelt(&mut self, global: &str) -> Option<Target> {
        if let Some(target) = self.find(global) {
            return Some(target);
        }
        let name = self.spelt.get(global)?.clone();
        self.find(&name)
    }

    /// What a name in the document stands for; an unknown one is reported.
    pub fn expect(
        &mut self,
        name: &Located<String>,
        diagnostics: &mut Vec<Diagnostic>,
    ) -> Option<Target> {
        let found = self.find(name);
        if found.is_some() || self.is_broken(name) {
            return found;
        }
        if let Some(of) = previous_of(name) {
            return self.explain_previous(name, of, diagnostics);
        }
        let whole = split_layer(name).map(|(whole, _)| whole.to_owned());
        if whole.as_ref().is_some_and(|whole| self.is_broken(whole)) {
            return None;
        }
        if let Some(Target { id, part }) = whole.as_ref().and_then(|whole| self.find(whole)) {
            let resource = self.get(id);
            let what = match &resource.kind {
                ResourceKind::Texture(_) => match part.layers.len() {
                    1 => "it has one layer, [0]".to_owned(),
                    count => format!("its layers are [0] to [{}]", count - 1),
                },
                other => format!("it is {}, only textures have layers", other.describe()),
            };
            let mut error = Diagnostic::error(Code::Size, format!("there is no `{}`", name.value))
                .at(name.span.clone(), what);
            if let Some(declared) = &resource.declared {
                error = error.at(declared.clone(), "declared here");
            }
            diagnostics.push(error);
        } else {
            let found = diagnostics.len();
            let known = if found < HINTED {
                self.known()
            } else {
                Vec::new()
            };
            let error = Diagnostic::error(
                Code::UnknownResource,
                format!("nothing is called `{}`", name.value),
            )
            .at(
                name.span.clone(),
                "no material or provided resource has this name",
            );
            diagnostics.push(if name.contains("[index]") {
                error.help("`index` is that of a repeat, and there is none around this: write a number, or `repeat: …`")
            } else {
                error.suggest_to(found, name, || known.iter().map(String::as_str))
            });
        }
        None
    }

    /// Every name there is, materials first.
    pub fn known(&self) -> Vec<String> {
        let mut names: Vec<String> = self.names.keys().cloned().collect();
        names.sort();
        names.splice(0..0, self.nearby.iter().flat_map(PassScope::names));
        let provided: Vec<String> = self
            .provider
            .names()
            .into_iter()
            .filter(|name| !names.contains(name))
            .collect();
        names.extend(provided);
        names
    }

    /// The number of items that a count stands for, once every size is known.
    pub fn count(
        &mut self,
        count: &Count,
        params: &Params,
        diagnostics: &mut Vec<Diagnostic>,
    ) -> Option<u64> {
        match count {
            Count::Number(value) => params.value(value, diagnostics).map(u64::from),
            Count::Pixels => Some(u64::from(self.viewport[0]) * u64::from(self.viewport[1])),
            Count::Times(a, b) => {
                let (a, b) = (
                    self.count(a, params, diagnostics)?,
                    self.count(b, params, diagnostics)?,
                );
                Some(a.saturating_mul(b))
            }
            Count::PixelsOf(name) | Count::CountOf(name) => {
                let target = self.expect(name, diagnostics)?;
                let items = match &self.get(target.id).kind {
                    ResourceKind::Texture(texture) => {
                        Some(u64::from(texture.size[0]) * u64::from(texture.size[1]))
                    }
                    ResourceKind::Buffer(buffer) => buffer.count,
                    ResourceKind::Provided(provided) => provided.items,
                    ResourceKind::Sampler(_) => None,
                };
                if items.is_none() {
                    diagnostics.push(
                        Diagnostic::error(Code::Size, format!("the number of items of `{}` is not known", name.value))
                            .at(name.span.clone(), self.get(target.id).kind.describe())
                            .help("count a buffer that declares its `count`, or a provided resource that knows it beforehand"),
                    );
                }
                items
            }
        }
    }
}
