//! Phase 9, first half: textures, buffers and samplers of what the live passes touch.

use crate::{
    document::materials::{Address, Filter, SamplerEntry},
    execute::{ExecuteError, scoped},
    plan::Plan,
    provider::{Import, Provider},
    resolve::{Origin, Part, Resource, ResourceId, ResourceKind, Target},
};
use std::collections::{BTreeMap, HashMap};

/// A texture or buffer on the device.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Physical {
    Texture(wgpu::Texture),
    Buffer(wgpu::Buffer),
}

/// Which of its two allocations a resource is written to in a frame, and which one holds what it was before; both the same in a
/// frame that does not write it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Versions {
    pub current: usize,
    pub previous: usize,
}

/// Resources that are also read as they were in the frame before.
pub(crate) type Histories = BTreeMap<ResourceId, Versions>;

/// One allocation that resources take turns in, or two of one resource with a history.
struct Made {
    label: String,
    usage: (wgpu::TextureUsages, wgpu::BufferUsages),
    versions: Vec<Physical>,
}

impl Made {
    /// Makes what resources take turns in, or takes it from what is known by label.
    fn new(
        plan: &Plan,
        tenants: &[ResourceId],
        known: &mut HashMap<&str, &Made>,
        device: &wgpu::Device,
    ) -> Result<Self, ExecuteError> {
        let id = tenants[0];
        let resource = &plan.resources[id.0];
        let lifetime = &plan.lifetimes[&id];
        let names: Vec<&str> = tenants
            .iter()
            .map(|tenant| plan.resources[tenant.0].name.as_str())
            .collect();
        let label = names.join(" / ");
        let usage = (lifetime.textures, lifetime.buffers);
        let count = plan.versions(id);
        let kept = known.remove(label.as_str()).filter(|made| {
            made.usage == usage
                && made.versions.len() == count
                && made
                    .versions
                    .iter()
                    .all(|version| is_made(version, resource))
        });
        if let Some(made) = kept {
            return Ok(Self {
                label,
                usage,
                versions: made.versions.clone(),
            });
        }
        let make = || match &resource.kind {
            ResourceKind::Texture(texture) => {
                Physical::Texture(device.create_texture(&wgpu::TextureDescriptor {
                    label: Some(&label),
                    size: wgpu::Extent3d {
                        width: texture.size[0],
                        height: texture.size[1],
                        depth_or_array_layers: texture.layers,
                    },
                    mip_level_count: texture.mips,
                    sample_count: 1,
                    dimension: wgpu::TextureDimension::D2,
                    format: texture.format,
                    usage: usage.0,
                    view_formats: &[],
                }))
            }
            ResourceKind::Buffer(buffer) => {
                Physical::Buffer(device.create_buffer(&wgpu::BufferDescriptor {
                    label: Some(&label),
                    size: buffer.bytes,
                    usage: usage.1,
                    mapped_at_creation: false,
                }))
            }
            _ => unreachable!("only textures and buffers have slots"),
        };
        let versions = (0..count)
            .map(|_| scoped(device, &label, make))
            .collect::<Result<_, _>>()?;
        Ok(Self {
            label,
            usage,
            versions,
        })
    }
}

/// Textures, buffers and samplers of a plan.
#[derive(Default)]
pub(crate) struct Memory {
    slots: Vec<Made>,
    of: BTreeMap<ResourceId, usize>,
    /// What a resource is last frame's version of.
    bases: BTreeMap<ResourceId, ResourceId>,
    /// Provided resources and imports; the latter from when the host has handed them over.
    host: BTreeMap<ResourceId, Physical>,
    /// Imports that no live pass uses, for plans in which one does.
    spare: BTreeMap<String, Physical>,
    samplers: BTreeMap<ResourceId, wgpu::Sampler>,
    /// Versions of the provided resources.
    provided: BTreeMap<ResourceId, u64>,
}

impl Memory {
    /// The texture or buffer behind a resource in a frame; `None` for an import that is not there yet.
    fn find(&self, id: ResourceId, histories: &Histories) -> Option<&Physical> {
        if let Some(host) = self.host.get(&id) {
            return Some(host);
        }
        let (base, version) = match self.bases.get(&id) {
            Some(base) => (*base, histories.get(base)?.previous),
            None => (id, histories.get(&id).map_or(0, |version| version.current)),
        };
        self.slots.get(*self.of.get(&base)?)?.versions.get(version)
    }

    pub fn texture(
        &self,
        id: ResourceId,
        histories: &Histories,
    ) -> Result<&wgpu::Texture, ExecuteError> {
        match self.find(id, histories) {
            Some(Physical::Texture(texture)) => Ok(texture),
            _ => Err(ExecuteError::Internal(
                "a texture that a live pass uses was not made",
            )),
        }
    }

    pub fn buffer(
        &self,
        id: ResourceId,
        histories: &Histories,
    ) -> Result<&wgpu::Buffer, ExecuteError> {
        match self.find(id, histories) {
            Some(Physical::Buffer(buffer)) => Ok(buffer),
            _ => Err(ExecuteError::Internal(
                "a buffer that a live pass uses was not made",
            )),
        }
    }

    pub fn sampler(&self, id: ResourceId) -> Result<&wgpu::Sampler, ExecuteError> {
        self.samplers.get(&id).ok_or(ExecuteError::Internal(
            "a sampler that a live pass uses was not made",
        ))
    }

    /// A view of one part, of the dimension that a shader or an attachment sees.
    pub fn view(
        &self,
        target: &Target,
        dimension: wgpu::TextureViewDimension,
        histories: &Histories,
    ) -> Result<wgpu::TextureView, ExecuteError> {
        let Part { mips, layers } = &target.part;
        Ok(self
            .texture(target.id, histories)?
            .create_view(&wgpu::TextureViewDescriptor {
                dimension: Some(dimension),
                base_mip_level: mips.start,
                mip_level_count: Some(mips.len() as u32),
                base_array_layer: layers.start,
                array_layer_count: Some(layers.len() as u32),
                ..wgpu::TextureViewDescriptor::default()
            }))
    }

    /// Makes every resource with a lifetime; provided ones are asked of the provider, and only here. What `old` has of the same
    /// name and make is taken over with its content.
    pub fn new(
        plan: &Plan,
        old: Option<(&Plan, &Memory)>,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        provider: &mut dyn Provider,
    ) -> Result<Self, ExecuteError> {
        let mut memory = Self {
            of: plan.slots.of.clone(),
            ..Self::default()
        };
        let known = old.iter().flat_map(|(_, old)| &old.slots);
        let mut known: HashMap<&str, &Made> =
            known.map(|made| (made.label.as_str(), made)).collect();
        for slot in &plan.slots.list {
            let made = Made::new(plan, &slot.tenants, &mut known, device)?;
            memory.slots.push(made);
        }
        for &id in plan.lifetimes.keys() {
            let resource = &plan.resources[id.0];
            match (&resource.kind, resource.origin) {
                (_, Origin::Previous(base)) => {
                    memory.bases.insert(id, base);
                }
                (ResourceKind::Sampler(entry), _) => {
                    let made = sampler(device, &resource.name, entry);
                    memory.samplers.insert(id, made);
                }
                (ResourceKind::Provided(_), _) => {
                    memory.refresh(id, resource, old, device, queue, provider)?;
                }
                (_, Origin::Host) => {
                    if let Some(import) = old.and_then(|old| kept_import(plan, &resource.name, old))
                    {
                        memory.host.insert(id, import);
                    }
                }
                _ => {}
            }
        }
        let used = |name: &String| {
            let mut live = plan.lifetimes.keys();
            live.any(|id| plan.resources[id.0].name == *name)
        };
        for name in plan.request.imports.keys().filter(|name| !used(name)) {
            if let Some(import) = old.and_then(|old| kept_import(plan, name, old)) {
                memory.spare.insert(name.clone(), import);
            }
        }
        Ok(memory)
    }

    /// Asks the provider for a resource if it has another version than the one that is there.
    pub fn refresh(
        &mut self,
        id: ResourceId,
        resource: &Resource,
        old: Option<(&Plan, &Memory)>,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        provider: &mut dyn Provider,
    ) -> Result<(), ExecuteError> {
        let version = provider.version(&resource.name);
        if let Some((plan, memory)) = old {
            let known = memory
                .host
                .iter()
                .find(|(id, _)| plan.resources[id.0].name == resource.name);
            if let Some((known, physical)) = known
                && memory.provided.get(known) == Some(&version)
            {
                self.host.insert(id, physical.clone());
                self.provided.insert(id, version);
                return Ok(());
            }
        }
        // The plan has counted items and sized buffers by what was described to it.
        if let (ResourceKind::Provided(planned), Some(now)) =
            (&resource.kind, provider.describe(&resource.name))
            && now != *planned
        {
            return Err(ExecuteError::Provider {
                name: resource.name.clone(),
                why: format!(
                    "it is {now:?} now, and was planned as {planned:?}: plan the graph anew"
                ),
            });
        }
        let built = scoped(device, &resource.name, || {
            provider.build(&resource.name, device, queue)
        })?;
        let buffer = built.map_err(|why| ExecuteError::Provider {
            name: resource.name.clone(),
            why: why.0,
        })?;
        // Only now: what could not be built is asked for again.
        self.host.insert(id, Physical::Buffer(buffer));
        self.provided.insert(id, version);
        Ok(())
    }

    /// The provided resources with the versions that are there.
    pub fn provided(&self) -> impl Iterator<Item = (ResourceId, u64)> + '_ {
        self.provided.iter().map(|(id, version)| (*id, *version))
    }

    /// The version that a provided resource was built of.
    pub fn version(&self, id: ResourceId) -> Option<u64> {
        self.provided.get(&id).copied()
    }

    /// What the host gave for a provided resource or an import.
    pub fn host(&self, id: ResourceId) -> Option<&Physical> {
        self.host.get(&id)
    }

    /// Sets an import; whether it is another one than before.
    pub fn import(&mut self, id: ResourceId, physical: Physical) -> bool {
        self.host.insert(id, physical.clone()) != Some(physical)
    }

    /// Keeps an import that no live pass uses.
    pub fn spare(&mut self, name: &str, physical: Physical) {
        self.spare.insert(name.to_owned(), physical);
    }

    /// Whether a resource has the very memory in two states of an executor, and so its content.
    pub fn same(&self, id: ResourceId, other: &Memory, of_other: ResourceId) -> bool {
        let versions = |memory: &Memory, id: ResourceId| -> Option<Vec<Physical>> {
            if let Some(host) = memory.host.get(&id) {
                return Some(vec![host.clone()]);
            }
            let base = memory.bases.get(&id).unwrap_or(&id);
            Some(memory.slots[*memory.of.get(base)?].versions.clone())
        };
        let (a, b) = (versions(self, id), versions(other, of_other));
        a.is_some() && a == b
    }
}

/// Whether a texture or buffer is what a plan says of a resource.
fn is_made(physical: &Physical, resource: &Resource) -> bool {
    match (physical, &resource.kind) {
        (Physical::Texture(texture), ResourceKind::Texture(wanted)) => {
            texture.format() == wanted.format
                && [texture.width(), texture.height()] == wanted.size
                && texture.mip_level_count() == wanted.mips
                && texture.depth_or_array_layers() == wanted.layers
        }
        (Physical::Buffer(buffer), ResourceKind::Buffer(wanted)) => buffer.size() == wanted.bytes,
        _ => false,
    }
}

/// An import that was handed over before, if it is still described the same way.
fn kept_import(plan: &Plan, name: &str, (of, memory): (&Plan, &Memory)) -> Option<Physical> {
    let described = |plan: &Plan| plan.request.imports.get(name).copied();
    if described(plan) != described(of) {
        return None;
    }
    let mut live = memory.host.iter();
    let live = live.find(|(id, _)| of.resources[id.0].name == name);
    let physical = live.map(|(_, physical)| physical);
    physical.or_else(|| memory.spare.get(name)).cloned()
}

/// Why a texture or buffer is not what the host said that it would import; it may have been made for more besides.
pub(crate) fn differs(physical: &Physical, described: &Import) -> Option<String> {
    fn unless<T: PartialEq + std::fmt::Debug>(what: &str, planned: T, given: T) -> Option<String> {
        (planned != given).then(|| format!("{what} is {given:?}, not {planned:?}"))
    }
    let differences = match (physical, *described) {
        (
            Physical::Texture(texture),
            Import::Texture {
                format,
                size,
                mips,
                layers,
                usage,
            },
        ) => [
            unless("its format", format, texture.format()),
            unless("its size", size, [texture.width(), texture.height()]),
            unless("its number of mips", mips, texture.mip_level_count()),
            unless(
                "its number of layers",
                layers,
                texture.depth_or_array_layers(),
            ),
            unless("its usage", usage, texture.usage() & usage),
        ]
        .to_vec(),
        (Physical::Buffer(buffer), Import::Buffer { bytes, usage, .. }) => vec![
            unless("its size in bytes", bytes, buffer.size()),
            unless("its usage", usage, buffer.usage() & usage),
        ],
        (Physical::Texture(_), _) => vec![Some("it is a texture, not a buffer".to_owned())],
        (Physical::Buffer(_), _) => vec![Some("it is a buffer, not a texture".to_owned())],
    };
    let differences: Vec<String> = differences.into_iter().flatten().collect();
    (!differences.is_empty()).then(|| differences.join("; "))
}

fn sampler(device: &wgpu::Device, name: &str, entry: &SamplerEntry) -> wgpu::Sampler {
    let address = match entry.address {
        Address::ClampToEdge => wgpu::AddressMode::ClampToEdge,
        Address::Repeat => wgpu::AddressMode::Repeat,
        Address::MirrorRepeat => wgpu::AddressMode::MirrorRepeat,
    };
    let (filter, mip) = match entry.filter {
        Filter::Nearest => (wgpu::FilterMode::Nearest, wgpu::MipmapFilterMode::Nearest),
        Filter::Linear => (wgpu::FilterMode::Linear, wgpu::MipmapFilterMode::Linear),
    };
    device.create_sampler(&wgpu::SamplerDescriptor {
        label: Some(name),
        address_mode_u: address,
        address_mode_v: address,
        address_mode_w: address,
        mag_filter: filter,
        min_filter: filter,
        mipmap_filter: mip,
        compare: entry.compare.map(Into::into),
        ..wgpu::SamplerDescriptor::default()
    })
}
