//! Memory of a plan: created here, built by the provider, or imported by the host.

use super::allocation::{GpuAllocation, Known};
use super::import::is_on;
use super::physical::{Physical, PingPong, Work};
use crate::buffer;
use crate::error::ExecuteError::{self, Internal};
use crate::error::scoped;
use crate::presence::Presence;
use crate::provider::{Provider, ProviderError};
use skiagraph_graph::{
    Address, Aliases, FRAME_BYTES, Filter, Origin, Plan, Provided, ProvidedBinding, Resource,
    ResourceId, ResourceKind, Sampler, Target,
};
use std::{collections::BTreeMap, ops::Range};

/// All textures, buffers and samplers of a plan.
#[derive(Default)]
pub(crate) struct Memory {
    allocations: Vec<GpuAllocation>,
    aliases: Aliases,
    /// The resource that each `.previous` resource belongs to, if its two allocations alternate.
    bases: BTreeMap<ResourceId, ResourceId>,
    /// Provided resources, their `.previous` copies, the uniform `frame`, samplers, and the imports
    /// that the host has set.
    host: BTreeMap<ResourceId, Physical>,
    /// Imports by name that no live pass uses; a later plan may use them.
    spare: BTreeMap<String, Physical>,
    /// Version of each provided resource, or the part that is missing to build it.
    provided: BTreeMap<ResourceId, Result<u64, String>>,
    /// Content of each uniform that the commands of every frame write: `frame`, and those whose
    /// bytes the provider tells.
    uniforms: BTreeMap<ResourceId, Vec<u8>>,
}

/// A buffer or texture, and the larger one that takes over its content.
pub(crate) type Grown = (Physical, Physical);

/// Device, queue and provider that memory is created with.
pub(crate) struct ResourceFactory<'a> {
    pub device: &'a wgpu::Device,
    pub queue: &'a wgpu::Queue,
    pub provider: &'a mut dyn Provider,
}

impl<'a> ResourceFactory<'a> {
    pub fn new(
        (device, queue): (&'a wgpu::Device, &'a wgpu::Queue),
        provider: &'a mut dyn Provider,
    ) -> Self {
        Self {
            device,
            queue,
            provider,
        }
    }

    /// Has the provider submit what it has recorded.
    pub fn submit_built(&mut self) -> Result<(), ExecuteError> {
        let name = "what the provider copies";
        let submit = || self.provider.submit_built(self.device, self.queue);
        let submitted = scoped(self.device, name, submit)?;
        submitted.map_err(|why| ExecuteError::Provider {
            name: name.to_owned(),
            why,
        })
    }
}

impl Memory {
    /// Creates every resource that a live pass uses, and asks the provider for the provided ones.
    /// Resources of `old` with the same name and properties are reused with their content.
    pub fn new(
        plan: &Plan,
        old: Option<(&Plan, &Memory)>,
        factory: &mut ResourceFactory<'_>,
    ) -> Result<Self, ExecuteError> {
        check_relied_on(plan, factory.provider)?;
        let mut memory = Self {
            aliases: plan.schedule().aliases.clone(),
            ..Self::default()
        };
        let mut reusable = Known::new();
        if let Some((plan, old)) = old {
            let allocations = old.allocations.iter();
            reusable.extend(allocations.map(|made| (made.label.as_str(), (plan, made))));
        }
        for allocation in &plan.schedule().aliases.list {
            let (device, queue) = (factory.device, factory.queue);
            let made = GpuAllocation::new(plan, allocation, &mut reusable, device, queue)?;
            memory.allocations.push(made);
        }
        let mut lifetimes = plan.schedule().lifetimes.keys();
        let entered = lifetimes.try_for_each(|&id| memory.enter(plan, id, old, factory));
        let submitted = factory.submit_built();
        entered.and(submitted)?;
        let used = |name: &String| plan.used().any(|used| used.name == *name);
        for name in plan.imports().keys().filter(|name| !used(name)) {
            if let Some(import) = old.and_then(|old| kept_import(plan, name, old)) {
                memory.spare.insert(name.clone(), import);
            }
        }
        Ok(memory)
    }

    /// Creates the memory of a resource that has no allocation in the plan.
    fn enter(
        &mut self,
        plan: &Plan,
        id: ResourceId,
        old: Option<(&Plan, &Memory)>,
        factory: &mut ResourceFactory<'_>,
    ) -> Result<(), ExecuteError> {
        let resource = plan.resource(id);
        match (&resource.kind, resource.origin) {
            // The base has the smaller number, so it is there.
            (ResourceKind::Provided(provided), Origin::Previous(base)) => {
                let size = match self.buffer(base, &PingPong::new()) {
                    Ok(base) => base.size(),
                    // It is missing, and as large as described when it comes.
                    Err(_) => provided.items.unwrap_or(1).max(1) * provided.stride,
                };
                let usage = provided.binding.usages();
                self.own_buffer(id, &resource.name, (size, usage), old, factory.device)?;
            }
            (_, Origin::Previous(base)) => {
                self.bases.insert(id, base);
            }
            (
                ResourceKind::Provided(_)
                | ResourceKind::AccelerationStructure
                | ResourceKind::CpuWork,
                _,
            ) => {
                self.refresh(id, plan, old, factory)?;
            }
            (ResourceKind::Frame, _) => {
                let usage = wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_SRC;
                self.own_buffer(
                    id,
                    &resource.name,
                    (FRAME_BYTES, usage),
                    old,
                    factory.device,
                )?;
                self.uniforms.insert(id, vec![0; FRAME_BYTES as usize]);
            }
            (_, Origin::Host) => {
                if let Some(import) = old.and_then(|old| kept_import(plan, &resource.name, old)) {
                    self.host.insert(id, import);
                }
            }
            (ResourceKind::Sampler(entry), _) => {
                let made = sampler(factory.device, &resource.name, entry);
                self.host.insert(id, Physical::Sampler(made));
            }
            _ => {}
        }
        Ok(())
    }

    /// Creates a buffer that is copied to, or reuses the one of the same name and size.
    fn own_buffer(
        &mut self,
        id: ResourceId,
        name: &str,
        (size, usage): (u64, wgpu::BufferUsages),
        old: Option<(&Plan, &Memory)>,
        device: &wgpu::Device,
    ) -> Result<(), ExecuteError> {
        let former = old.and_then(|(plan, memory)| memory.host_by_name(plan, name));
        let usage = usage | wgpu::BufferUsages::COPY_DST;
        let buffer = match former {
            Some((_, Physical::Buffer(buffer)))
                if buffer.size() == size && buffer.usage() == usage =>
            {
                buffer.clone()
            }
            _ => scoped(device, name, || buffer::make(device, name, size, usage))?,
        };
        self.host.insert(id, Physical::Buffer(buffer));
        Ok(())
    }

    /// Returns the id and memory of the host's resource with this name.
    fn host_by_name(&self, plan: &Plan, name: &str) -> Option<(ResourceId, &Physical)> {
        let mut host = self.host.iter();
        let entry = host.find(|(id, _)| plan.resource(**id).name == name);
        entry.map(|(id, physical)| (*id, physical))
    }

    /// Returns the memory of a resource in a frame; `None` for an import that is not there yet.
    fn find(&self, id: ResourceId, ping_pong: &PingPong) -> Option<&Physical> {
        if let Some(host) = self.host.get(&id) {
            return Some(host);
        }
        let (base, version) = match self.bases.get(&id) {
            Some(base) => (*base, ping_pong.get(base)?.previous),
            None => (id, ping_pong.get(&id).map_or(0, |version| version.current)),
        };
        let allocation = self.allocations.get(*self.aliases.of.get(&base)?)?;
        allocation.versions.get(version)
    }

    pub fn buffer(
        &self,
        id: ResourceId,
        ping_pong: &PingPong,
    ) -> Result<&wgpu::Buffer, ExecuteError> {
        match self.find(id, ping_pong) {
            Some(Physical::Buffer(buffer)) => Ok(buffer),
            _ => Err(Internal("a buffer that a live pass uses was not made")),
        }
    }

    /// Returns the bytes that a resource has in its allocation; `None` for one of the host.
    fn place(&self, id: ResourceId) -> Option<Range<u64>> {
        let base = self.bases.get(&id).unwrap_or(&id);
        self.aliases.places.get(base).cloned()
    }

    pub fn acceleration_structure(&self, id: ResourceId) -> Result<&wgpu::Tlas, ExecuteError> {
        match self.host.get(&id) {
            Some(Physical::AccelerationStructure(structure)) => Ok(structure),
            _ => Err(Internal(
                "an acceleration structure that a live pass uses was not made",
            )),
        }
    }

    pub fn cpu_work(&self, id: ResourceId) -> Result<&Work, ExecuteError> {
        match self.host.get(&id) {
            Some(Physical::CpuWork(work)) => Ok(work),
            _ => Err(Internal(
                "work for the CPU that a live pass uses was not made",
            )),
        }
    }

    pub fn sampler(&self, id: ResourceId) -> Result<&wgpu::Sampler, ExecuteError> {
        match self.host.get(&id) {
            Some(Physical::Sampler(sampler)) => Ok(sampler),
            _ => Err(Internal("a sampler that a live pass uses was not made")),
        }
    }

    /// Gives up a provided resource whose content is not there, so that the provider is asked for
    /// it again.
    pub fn forget(&mut self, id: ResourceId, why: String) {
        self.host.remove(&id);
        self.uniforms.remove(&id);
        self.provided.insert(id, Err(why));
    }

    /// Returns the contents of the uniforms that the commands of every frame write.
    pub fn uniforms(&self) -> &BTreeMap<ResourceId, Vec<u8>> {
        &self.uniforms
    }

    /// Sets the content of such a uniform.
    pub fn set_uniform(&mut self, id: ResourceId, content: &[u8]) {
        if let Some(before) = self.uniforms.get_mut(&id) {
            before.copy_from_slice(content);
        }
    }

    /// Asks the provider for the bytes of a uniform. Returns false if it has none to tell.
    fn refresh_uniform(
        &mut self,
        id: ResourceId,
        resource: &Resource,
        old: Option<(&Plan, &Memory)>,
        factory: &mut ResourceFactory<'_>,
    ) -> Result<bool, ExecuteError> {
        let ResourceKind::Provided(provided) = &resource.kind else {
            return Ok(false);
        };
        let size = provided.items.unwrap_or(1).saturating_mul(provided.stride);
        let most = factory.device.limits().max_uniform_buffer_binding_size;
        let is_copied = size <= most && size.is_multiple_of(wgpu::COPY_BUFFER_ALIGNMENT);
        if provided.binding != ProvidedBinding::Uniform || !is_copied {
            return Ok(false);
        }
        let name = &resource.name;
        let mut content = vec![0; size as usize];
        let write = || factory.provider.write_uniform(name, &mut content);
        let written = scoped(factory.device, name, write)?;
        let is_written = written.map_err(|why| ExecuteError::Provider {
            name: name.clone(),
            why,
        })?;
        if !is_written {
            return Ok(false);
        }
        if !self.uniforms.contains_key(&id) {
            // A buffer of the provider is not to be written.
            let is_own = |(plan, memory): &(&Plan, &Memory)| {
                let former = memory.host_by_name(plan, name);
                former.is_some_and(|(id, _)| memory.uniforms.contains_key(&id))
            };
            let usage = provided.binding.usages() | wgpu::BufferUsages::COPY_SRC;
            let old = old.filter(is_own);
            self.own_buffer(id, name, (size, usage), old, factory.device)?;
        }
        self.uniforms.insert(id, content);
        Ok(true)
    }

    /// Asks the provider for a resource, unless `old` has it in the same version.
    pub fn refresh(
        &mut self,
        id: ResourceId,
        plan: &Plan,
        old: Option<(&Plan, &Memory)>,
        factory: &mut ResourceFactory<'_>,
    ) -> Result<(), ExecuteError> {
        let resource = plan.resource(id);
        let is_described = check_bound(resource, factory.provider)?;
        let provider = &mut *factory.provider;
        let version = provider.version(&resource.name);
        if let Some((plan, memory)) = old
            && let Some((old_id, physical)) = memory.host_by_name(plan, &resource.name)
            && memory.version(old_id) == Some(version)
            && is_described
        {
            self.host.insert(id, physical.clone());
            let content = memory.uniforms.get(&old_id).cloned();
            self.uniforms.extend(content.map(|content| (id, content)));
            self.provided.insert(id, Ok(version));
            return Ok(());
        }
        if let Some(why) = provider.missing(&resource.name) {
            self.forget(id, why);
            return Ok(());
        }
        if self.refresh_uniform(id, resource, old, factory)? {
            self.provided.insert(id, Ok(version));
            return Ok(());
        }
        let (provider, device) = (&mut *factory.provider, factory.device);
        let (name, queue) = (&resource.name, factory.queue);
        let built = scoped(device, name, || match resource.kind {
            ResourceKind::AccelerationStructure => {
                let built = provider.build_acceleration_structure(name, device, queue);
                built.map(Physical::AccelerationStructure)
            }
            ResourceKind::CpuWork => {
                let work = provider.build_cpu_work(name);
                work.map(|work| Physical::CpuWork(Work(work)))
            }
            _ => provider.build(name, device, queue).map(Physical::Buffer),
        })?;
        let refused = |why: ProviderError| ExecuteError::Provider {
            name: resource.name.clone(),
            why,
        };
        let built = built.map_err(refused)?;
        // One that knows its device was asked before.
        if provider.device().is_none() && !is_on(device, &built) {
            let name = format!("the provided resource `{}`", resource.name);
            let way_out = "have the provider build it on the device that it is given";
            return Presence::new(device)?.check_own(false, name, way_out);
        }
        if !is_copyable(&built) && is_read_as_before(id, plan) {
            return Err(refused(
                "it is read as it was in the frame before, so it must be made with \
                 BufferUsages::COPY_SRC"
                    .into(),
            ));
        }
        // Only now: what could not be built is asked for again.
        self.uniforms.remove(&id);
        self.host.insert(id, built);
        self.provided.insert(id, Ok(version));
        Ok(())
    }

    /// Returns the version of each provided resource, or the part that is missing to build it.
    pub fn provided(&self) -> &BTreeMap<ResourceId, Result<u64, String>> {
        &self.provided
    }

    /// Returns the version that a provided resource was built from; `None` if it is not built.
    pub fn version(&self, id: ResourceId) -> Option<u64> {
        self.provided.get(&id)?.as_ref().ok().copied()
    }

    /// Returns the part that is missing to build a provided resource; `None` if it is built.
    pub fn missing(&self, id: ResourceId) -> Option<&str> {
        self.provided.get(&id)?.as_ref().err().map(String::as_str)
    }

    /// Returns the host's memory for a provided resource or an import.
    pub fn host(&self, id: ResourceId) -> Option<&Physical> {
        self.host.get(&id)
    }

    /// Sets an import. Returns true if it differs from the one before.
    pub fn import(&mut self, id: ResourceId, physical: Physical) -> bool {
        self.host.insert(id, physical.clone()) != Some(physical)
    }

    /// Keeps an import that no live pass uses.
    pub fn spare(&mut self, name: &str, physical: Physical) {
        self.spare.insert(name.to_owned(), physical);
    }

    /// True if both are buffers of the same size and usage, so that the device accepts one wherever
    /// it accepts the other.
    pub fn is_alike(one: Option<&Physical>, other: Option<&Physical>) -> bool {
        match (one, other) {
            (Some(Physical::Buffer(one)), Some(Physical::Buffer(other))) => {
                one.size() == other.size() && one.usage() == other.usage()
            }
            _ => false,
        }
    }

    /// True if a resource is larger than in the former plan, with the same content.
    pub fn is_grown(&self, id: ResourceId) -> bool {
        let allocation = self.aliases.of.get(&id).map(|at| &self.allocations[*at]);
        allocation.is_some_and(|allocation| allocation.grown_from.is_some())
    }

    /// Takes the smaller resources whose content must be copied, each with its larger successor.
    pub fn take_grown(&mut self) -> Vec<Grown> {
        let grown = self.allocations.iter_mut().filter_map(|allocation| {
            let from = allocation.grown_from.take()?;
            Some((from, allocation.versions.first()?.clone()))
        });
        grown.collect()
    }

    /// True if a resource has the very same memory, and so the same content, in two states of an
    /// executor.
    pub fn same(&self, id: ResourceId, other: &Memory, of_other: ResourceId) -> bool {
        let versions = |memory: &Memory, id: ResourceId| {
            if let Some(host) = memory.host.get(&id) {
                return Some((vec![host.clone()], None));
            }
            let base = memory.bases.get(&id).unwrap_or(&id);
            let (slot, place) = (memory.aliases.of.get(base)?, memory.place(id));
            Some((memory.allocations[*slot].versions.clone(), place))
        };
        let (a, b) = (versions(self, id), versions(other, of_other));
        a.is_some() && a == b
    }
}

/// A plan's memory in a frame.
#[derive(Clone, Copy)]
pub(crate) struct InFrame<'a> {
    pub plan: &'a Plan,
    pub memory: &'a Memory,
    pub ping_pong: &'a PingPong,
}

impl<'a> InFrame<'a> {
    pub fn new(plan: &'a Plan, memory: &'a Memory, ping_pong: &'a PingPong) -> Self {
        Self {
            plan,
            memory,
            ping_pong,
        }
    }

    pub fn texture(self, id: ResourceId) -> Result<&'a wgpu::Texture, ExecuteError> {
        match self.memory.find(id, self.ping_pong) {
            Some(Physical::Texture(texture)) => Ok(texture),
            _ => Err(Internal("a texture that a live pass uses was not made")),
        }
    }

    /// Returns the buffer that holds a part of a plan's buffer, and the part's bytes.
    pub fn bytes(self, target: &Target) -> Result<(&'a wgpu::Buffer, Range<u64>), ExecuteError> {
        let buffer = self.memory.buffer(target.id, self.ping_pong)?;
        let place = self.memory.place(target.id).unwrap_or(0..buffer.size());
        let stride = match &self.plan.resource(target.id).kind {
            ResourceKind::Buffer(buffer) => buffer.stride,
            ResourceKind::Provided(provided) => provided.stride,
            _ => 0,
        };
        let at = |item: u32| place.start + u64::from(item) * stride;
        let items = target.part.items();
        let bytes = items.map(|items| at(items.start)..at(items.end));
        Ok((buffer, bytes.unwrap_or(place)))
    }

    /// Returns a view of a part of a texture, with the dimension that a shader or attachment needs.
    pub fn view(
        self,
        target: &Target,
        dimension: wgpu::TextureViewDimension,
    ) -> Result<wgpu::TextureView, ExecuteError> {
        let texture = self.texture(target.id)?;
        let (mips, layers) = (&target.part.mips, &target.part.layers);
        // Slices of a 3D texture are no layers of a view.
        let is_3d = texture.dimension() == wgpu::TextureDimension::D3;
        Ok(texture.create_view(&wgpu::TextureViewDescriptor {
            dimension: Some(dimension),
            aspect: target.part.aspect,
            base_mip_level: mips.start,
            mip_level_count: Some(mips.len() as u32),
            base_array_layer: if is_3d { 0 } else { layers.start },
            array_layer_count: (!is_3d).then_some(layers.len() as u32),
            ..wgpu::TextureViewDescriptor::default()
        }))
    }
}

/// Returns an error if the provider describes a resource on which a plan relies, though no live
/// pass binds it, otherwise than the plan was made for.
pub(crate) fn check_relied_on(plan: &Plan, provider: &dyn Provider) -> Result<(), ExecuteError> {
    let mut relied_on = plan.relies_on().iter();
    relied_on.try_for_each(|(name, planned)| as_planned(name, *planned, provider.describe(name)))
}

/// Returns an error if the provider describes a resource otherwise than planned, and false if it
/// does not describe it any more: asked for it, the provider tells why in its own words.
pub(crate) fn check_bound(
    resource: &Resource,
    provider: &dyn Provider,
) -> Result<bool, ExecuteError> {
    let planned = match &resource.kind {
        ResourceKind::Provided(planned) => *planned,
        ResourceKind::CpuWork => Provided::CPU_WORK,
        _ => Provided::ACCELERATION_STRUCTURE,
    };
    match provider.describe(&resource.name) {
        None => Ok(false),
        given => as_planned(&resource.name, Some(planned), given).map(|()| true),
    }
}

/// A plan has counted items and sized buffers by the descriptions that it was made for; one without
/// a kind has asked for none.
fn as_planned(
    name: &str,
    planned: Option<Provided>,
    mut given: Option<Provided>,
) -> Result<(), ExecuteError> {
    if let (Some(given), Some(planned)) = (&mut given, planned) {
        given.kind = given.kind.filter(|_| planned.kind.is_some());
    }
    if given == planned {
        return Ok(());
    }
    Err(ExecuteError::OtherThanPlanned {
        name: name.to_owned(),
        planned,
        given,
    })
}

fn is_copyable(built: &Physical) -> bool {
    match built {
        Physical::Buffer(buffer) => buffer.usage().contains(wgpu::BufferUsages::COPY_SRC),
        _ => true,
    }
}

/// True if a live pass reads a provided resource as `.previous`.
fn is_read_as_before(id: ResourceId, plan: &Plan) -> bool {
    plan.used()
        .any(|other| other.origin == Origin::Previous(id))
}

/// Returns an import that the host set for a former plan, if its description is unchanged.
fn kept_import(plan: &Plan, name: &str, (old, memory): (&Plan, &Memory)) -> Option<Physical> {
    let described = |plan: &Plan| plan.imports().get(name).copied();
    if described(plan) != described(old) {
        return None;
    }
    let live = memory.host_by_name(old, name).map(|(_, physical)| physical);
    live.or_else(|| memory.spare.get(name)).cloned()
}

fn sampler(device: &wgpu::Device, name: &str, entry: &Sampler) -> wgpu::Sampler {
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
        compare: entry.compare,
        ..wgpu::SamplerDescriptor::default()
    })
}
