//! Phase 9, first half: textures, buffers and samplers of what the live passes touch.

use crate::{
    document::materials::{Address, Filter, SamplerEntry},
    execute::{ExecuteError, scoped},
    plan::Plan,
    provider::Provider,
    resolve::{Part, ResourceId, ResourceKind, Target},
};
use std::collections::BTreeMap;

/// Textures, buffers and samplers of a plan.
#[derive(Default)]
pub(crate) struct Memory {
    textures: BTreeMap<ResourceId, wgpu::Texture>,
    buffers: BTreeMap<ResourceId, wgpu::Buffer>,
    samplers: BTreeMap<ResourceId, wgpu::Sampler>,
}

impl Memory {
    pub fn texture(&self, id: ResourceId) -> Result<&wgpu::Texture, ExecuteError> {
        self.textures.get(&id).ok_or(ExecuteError::Internal(
            "a texture that a live pass uses was not made",
        ))
    }

    pub fn buffer(&self, id: ResourceId) -> Result<&wgpu::Buffer, ExecuteError> {
        self.buffers.get(&id).ok_or(ExecuteError::Internal(
            "a buffer that a live pass uses was not made",
        ))
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
    ) -> Result<wgpu::TextureView, ExecuteError> {
        let Part { mips, layers } = &target.part;
        Ok(self
            .texture(target.id)?
            .create_view(&wgpu::TextureViewDescriptor {
                dimension: Some(dimension),
                base_mip_level: mips.start,
                mip_level_count: Some(mips.len() as u32),
                base_array_layer: layers.start,
                array_layer_count: Some(layers.len() as u32),
                ..wgpu::TextureViewDescriptor::default()
            }))
    }

    /// Makes every resource with a lifetime; provided ones are asked of the provider, and only here.
    pub fn new(
        plan: &Plan,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        provider: &mut dyn Provider,
    ) -> Result<Self, ExecuteError> {
        let mut memory = Self::default();
        for (&id, lifetime) in &plan.lifetimes {
            let resource = &plan.resources[id.0];
            match &resource.kind {
                ResourceKind::Texture(texture) => {
                    let made = scoped(device, &resource.name, || {
                        device.create_texture(&wgpu::TextureDescriptor {
                            label: Some(&resource.name),
                            size: wgpu::Extent3d {
                                width: texture.size[0],
                                height: texture.size[1],
                                depth_or_array_layers: texture.layers,
                            },
                            mip_level_count: texture.mips,
                            sample_count: 1,
                            dimension: wgpu::TextureDimension::D2,
                            format: texture.format,
                            usage: lifetime.textures,
                            view_formats: &[],
                        })
                    })?;
                    memory.textures.insert(id, made);
                }
                ResourceKind::Buffer(buffer) => {
                    let made = scoped(device, &resource.name, || {
                        device.create_buffer(&wgpu::BufferDescriptor {
                            label: Some(&resource.name),
                            size: buffer.bytes,
                            usage: lifetime.buffers,
                            mapped_at_creation: false,
                        })
                    })?;
                    memory.buffers.insert(id, made);
                }
                ResourceKind::Sampler(entry) => {
                    memory
                        .samplers
                        .insert(id, sampler(device, &resource.name, entry));
                }
                ResourceKind::Provided(_) => {
                    let built = scoped(device, &resource.name, || {
                        provider.build(&resource.name, device, queue)
                    })?;
                    let buffer = built.map_err(|why| ExecuteError::Provider {
                        name: resource.name.clone(),
                        why: why.0,
                    })?;
                    memory.buffers.insert(id, buffer);
                }
            }
        }
        Ok(memory)
    }
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
