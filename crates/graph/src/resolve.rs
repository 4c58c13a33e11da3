//! Phase 2: names become resources, sizes become numbers.

use crate::{
    diagnostics::{Code, Diagnostic},
    document::{
        located::Located,
        materials::{Count, Material, SamplerEntry, Size, TextureEntry},
    },
    provider::{Provided, Provider},
    registry::Params,
    source::Span,
};
use std::{collections::HashMap, ops::Range};

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
            Self::Sampler(_) => "a sampler",
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
        let mip = |mip: u32| wgpu::Extent3d {
            width: (self.size[0] >> mip).max(1),
            height: (self.size[1] >> mip).max(1),
            depth_or_array_layers: self.layers,
        };
        (0..self.mips).map(|level| self.format.theoretical_memory_footprint(mip(level))).sum()
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
    pub const ONE: Part = Part { mips: 0..1, layers: 0..1 };

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
    provider: &'a dyn Provider,
    viewport: [u32; 2],
}

/// What sizes are resolved against.
pub(crate) struct Environment<'a> {
    pub viewport: [u32; 2],
    pub limits: &'a wgpu::Limits,
    pub provider: &'a dyn Provider,
}

pub(crate) fn resolve<'a>(
    materials: &[Material],
    params: &Params<'_>,
    environment: &Environment<'a>,
    diagnostics: &mut Vec<Diagnostic>,
) -> Resources<'a> {
    let mut resources = Resources {
        list: Vec::new(),
        names: HashMap::new(),
        spelt: HashMap::new(),
        provider: environment.provider,
        viewport: environment.viewport,
    };
    for name in environment.provider.names() {
        resources.spelt.insert(spelling(&name), name);
    }
    let mut sizes = Sizes { materials, params, environment, open: Vec::new(), done: HashMap::new() };
    // Textures first: buffers may be counted by them, and by buffers above.
    for material in materials {
        let name = material.name();
        let declared = Some(name.span.clone());
        match material {
            Material::Texture(entry) => {
                if let Some(texture) = sizes.texture(entry, diagnostics) {
                    let id = resources.add(name.value.clone(), declared, ResourceKind::Texture(texture));
                    resources.add_views(entry, id, diagnostics);
                }
            }
            Material::Sampler(entry) => {
                resources.add(name.value.clone(), declared, ResourceKind::Sampler(entry.clone()));
            }
            Material::Buffer(_) => {}
        }
    }
    for material in materials {
        let Material::Buffer(entry) = material else { continue };
        let count = match &entry.count {
            None => None,
            Some(written) => match resources.count(written, params, diagnostics) {
                Some(0) => {
                    diagnostics.push(size_error(&entry.name, &written.span, "a buffer of no items", "give it one at least"));
                    continue;
                }
                Some(count) => Some(count),
                None => continue,
            },
        };
        let kind = ResourceKind::Buffer(Buffer { count, bytes: 0 });
        resources.add(entry.name.value.clone(), Some(entry.name.span.clone()), kind);
    }
    resources
}

/// A name as a WGSL identifier.
fn spelling(name: &str) -> String {
    name.replace(['.', '@', ' '], "_")
}

fn size_error(name: &Located<String>, span: &Span, what: &str, help: &str) -> Diagnostic {
    Diagnostic::error(Code::Size, format!("`{}`: {what}", name.value)).at(span.clone(), "").help(help)
}

impl Resources<'_> {
    /// Adds a resource under its name (and its spelling in WGSL).
    pub fn add(&mut self, name: String, declared: Option<Span>, kind: ResourceKind) -> ResourceId {
        let id = ResourceId(self.list.len());
        let part = match &kind {
            ResourceKind::Texture(texture) => Part { mips: 0..texture.mips, layers: 0..texture.layers },
            _ => Part::ONE,
        };
        self.names.insert(name.clone(), Target { id, part });
        self.spelt.insert(spelling(&name), name.clone());
        self.list.push(Resource { name, declared, kind });
        id
    }

    fn add_views(&mut self, entry: &TextureEntry, id: ResourceId, diagnostics: &mut Vec<Diagnostic>) {
        let ResourceKind::Texture(texture) = &self.list[id.0].kind else { return };
        let (mips, layers) = (texture.mips, texture.layers);
        for view in &entry.views {
            let end = |first: u32, count: Option<u32>, all: u32| count.map_or(Some(all), |count| first.checked_add(count));
            let range = |first: u32, count: Option<u32>, all: u32| {
                end(first, count, all).filter(|&end| first < end && end <= all).map(|end| first..end)
            };
            match (range(view.mip, view.mips, mips), range(view.layer, view.layers, layers)) {
                (Some(mips), Some(layers)) => {
                    self.names.insert(view.name.value.clone(), Target { id, part: Part { mips, layers } });
                    self.spelt.insert(spelling(&view.name), view.name.value.clone());
                }
                _ => diagnostics.push(
                    Diagnostic::error(Code::Size, format!("the view `{}` lies outside its texture", *view.name))
                        .at(view.name.span.clone(), "")
                        .help(format!("`{}` has {mips} mips and {layers} layers", *entry.name)),
                ),
            }
        }
    }

    pub fn get(&self, id: ResourceId) -> &Resource {
        &self.list[id.0]
    }

    /// What `name` stands for; a provided resource is entered at its first use.
    pub fn find(&mut self, name: &str) -> Option<Target> {
        if let Some(target) = self.names.get(name) {
            return Some(target.clone());
        }
        let provided = self.provider.describe(name)?;
        let id = self.add(name.to_owned(), None, ResourceKind::Provided(provided));
        Some(Target { id, part: Part { mips: 0..1, layers: 0..1 } })
    }

    /// What a shader global of that name stands for.
    pub fn find_spelt(&mut self, global: &str) -> Option<Target> {
        if let Some(target) = self.find(global) {
            return Some(target);
        }
        let name = self.spelt.get(global)?.clone();
        self.find(&name)
    }

    /// What a name in the document stands for, or a diagnostic.
    pub fn expect(&mut self, name: &Located<String>) -> Result<Target, Diagnostic> {
        self.find(name).ok_or_else(|| {
            let known = self.known();
            Diagnostic::error(Code::UnknownResource, format!("nothing is called `{}`", name.value))
                .at(name.span.clone(), "no material or provided resource has this name")
                .suggest(name, known.iter().map(String::as_str))
        })
    }

    /// Every name there is, materials first.
    pub fn known(&self) -> Vec<String> {
        let mut names: Vec<String> = self.names.keys().cloned().collect();
        names.sort();
        let provided: Vec<String> = self.provider.names().into_iter().filter(|name| !names.contains(name)).collect();
        names.extend(provided);
        names
    }

    /// The number of items that a count stands for, once every size is known.
    pub fn count(&mut self, count: &Count, params: &Params<'_>, diagnostics: &mut Vec<Diagnostic>) -> Option<u64> {
        match count {
            Count::Number(value) => params.value(value, diagnostics).map(u64::from),
            Count::Pixels => Some(u64::from(self.viewport[0]) * u64::from(self.viewport[1])),
            Count::Times(a, b) => {
                let (a, b) = (self.count(a, params, diagnostics)?, self.count(b, params, diagnostics)?);
                Some(a.saturating_mul(b))
            }
            Count::PixelsOf(name) | Count::CountOf(name) => {
                let target = match self.expect(name) {
                    Ok(target) => target,
                    Err(error) => {
                        diagnostics.push(error);
                        return None;
                    }
                };
                let items = match &self.get(target.id).kind {
                    ResourceKind::Texture(texture) => Some(u64::from(texture.size[0]) * u64::from(texture.size[1])),
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

/// Resolves sizes that may refer to each other.
struct Sizes<'a> {
    materials: &'a [Material],
    params: &'a Params<'a>,
    environment: &'a Environment<'a>,
    open: Vec<String>,
    done: HashMap<String, Option<[u32; 2]>>,
}

impl Sizes<'_> {
    fn texture(&mut self, entry: &TextureEntry, diagnostics: &mut Vec<Diagnostic>) -> Option<Texture> {
        let size = self.size(entry, diagnostics)?;
        let mips = self.params.value(&entry.mips, diagnostics)?;
        let layers = self.params.value(&entry.layers, diagnostics)?;
        let limits = self.environment.limits;
        let most = limits.max_texture_dimension_2d;
        if size.contains(&0) || mips == 0 || layers == 0 {
            diagnostics.push(size_error(&entry.name, &entry.size.span, "a texture of no texels", "give it one at least"));
            return None;
        }
        if size.iter().any(|&edge| edge > most) {
            diagnostics.push(size_error(
                &entry.name,
                &entry.size.span,
                &format!("{}×{} texels are more than the adapter can hold", size[0], size[1]),
                &format!("its limit is {most} in each direction"),
            ));
            return None;
        }
        if layers > limits.max_texture_array_layers {
            let help = format!("its limit is {}", limits.max_texture_array_layers);
            diagnostics.push(size_error(&entry.name, &entry.name.span, &format!("{layers} layers are more than the adapter can hold"), &help));
            return None;
        }
        let full = size[0].max(size[1]).ilog2() + 1;
        if mips > full {
            let help = format!("{}×{} texels have {full}", size[0], size[1]);
            diagnostics.push(size_error(&entry.name, &entry.name.span, &format!("{mips} mips are too many"), &help));
            return None;
        }
        Some(Texture { format: entry.format.0, size, mips, layers })
    }

    fn size(&mut self, entry: &TextureEntry, diagnostics: &mut Vec<Diagnostic>) -> Option<[u32; 2]> {
        let name = entry.name.value.clone();
        if let Some(known) = self.done.get(&name) {
            return *known;
        }
        if self.open.contains(&name) {
            diagnostics.push(size_error(&entry.name, &entry.size.span, "its size is that of itself", "give one of these textures a size of its own"));
            self.done.insert(name, None);
            return None;
        }
        self.open.push(name.clone());
        let [width, height] = self.environment.viewport;
        let size = match &entry.size.value {
            Size::Viewport => Some([width, height]),
            Size::ViewportTimes(factor) => self.params.value(factor, diagnostics).map(|factor| {
                // Saturates, NaN becomes 0: both are caught as sizes that cannot be.
                [width, height].map(|edge| (f64::from(edge) * f64::from(factor)).ceil() as u32)
            }),
            Size::Square(edge) => self.params.value(edge, diagnostics).map(|edge| [edge, edge]),
            Size::Texels(width, height) => {
                let (width, height) = (self.params.value(width, diagnostics), self.params.value(height, diagnostics));
                width.zip(height).map(|(width, height)| [width, height])
            }
            Size::Like(other) => self.like(other, diagnostics),
        };
        self.open.pop();
        self.done.entry(name).or_insert(size);
        size
    }

    fn like(&mut self, other: &Located<String>, diagnostics: &mut Vec<Diagnostic>) -> Option<[u32; 2]> {
        let materials = self.materials;
        let found = materials.iter().find_map(|material| match material {
            Material::Texture(texture) if texture.name.value == other.value => Some(texture),
            _ => None,
        });
        match found {
            Some(texture) => self.size(texture, diagnostics),
            None => {
                let textures = materials.iter().filter_map(|material| match material {
                    Material::Texture(texture) => Some(texture.name.as_str()),
                    _ => None,
                });
                diagnostics.push(
                    Diagnostic::error(Code::UnknownResource, format!("no texture is called `{}`", other.value))
                        .at(other.span.clone(), "")
                        .suggest(other, textures),
                );
                None
            }
        }
    }
}
