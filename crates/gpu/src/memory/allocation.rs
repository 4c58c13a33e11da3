//! Textures and buffers that the resources of a plan share, one after another.

use super::physical::Physical;
use crate::buffer;
use crate::error::{ExecuteError, scoped};
use skiagraph_graph::{Allocation, Origin, Plan, Resource, ResourceKind, Texture};
use std::collections::HashMap;

/// One texture or buffer that resources share, or two for a resource that is also read as
/// `.previous`.
pub(crate) struct GpuAllocation {
    pub label: String,
    usage: (wgpu::TextureUsages, wgpu::BufferUsages),
    pub versions: Vec<Physical>,
    /// The smaller buffer or texture whose content the next frame copies; `None` if it did not
    /// grow.
    pub grown_from: Option<Physical>,
}

/// Allocations of a former plan by their labels.
pub(super) type Known<'a> = HashMap<&'a str, (&'a Plan, &'a GpuAllocation)>;

impl GpuAllocation {
    /// Creates an allocation of a plan, or reuses the one with the same label.
    pub fn new(
        plan: &Plan,
        allocation: &Allocation,
        old: &mut Known<'_>,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
    ) -> Result<Self, ExecuteError> {
        let id = allocation.aliases[0];
        let resource = plan.resource(id);
        let lifetime = &plan.schedule().lifetimes[&id];
        let aliases = allocation.aliases.iter();
        let names: Vec<&str> = aliases.map(|id| plan.resource(*id).name.as_str()).collect();
        let label = names.join(" / ");
        let usage = (lifetime.textures, allocation.buffers);
        let bytes = allocation.bytes;
        let count = plan.versions(id);
        let kept = old.remove(label.as_str()).filter(|(old_plan, allocation)| {
            allocation.usage == usage
                && allocation.versions.len() == count
                && (!resource.keep || was(old_plan, resource).is_some_and(|it| it.keep))
        });
        let reused = kept.filter(|(old_plan, allocation)| {
            let mut versions = allocation.versions.iter();
            versions.all(|version| is_made(version, resource, bytes))
                && (resource.origin != Origin::Constant || holds_the_same(old_plan, resource))
        });
        let make = || make((resource, bytes), &label, usage, device);
        let (versions, grown_from) = match reused {
            Some((_, allocation)) => (allocation.versions.clone(), None),
            None => {
                let versions = (0..count).map(|_| scoped(device, &label, make)?);
                let versions = versions.collect::<Result<Vec<_>, ExecuteError>>()?;
                for version in &versions {
                    fill(version, resource, queue);
                }
                let grown = kept.and_then(|(old_plan, it)| grown(old_plan, it, resource));
                (versions, grown)
            }
        };
        Ok(Self {
            label,
            usage,
            versions,
            grown_from,
        })
    }
}

fn make(
    (resource, bytes): (&Resource, u64),
    label: &str,
    (textures, buffers): (wgpu::TextureUsages, wgpu::BufferUsages),
    device: &wgpu::Device,
) -> Result<Physical, ExecuteError> {
    match &resource.kind {
        ResourceKind::Texture(texture) => {
            let descriptor = wgpu::TextureDescriptor {
                label: Some(label),
                size: extent(texture, 0, texture.layers),
                mip_level_count: texture.mips,
                sample_count: texture.samples,
                dimension: dimension(texture.is_3d),
                format: texture.format,
                usage: textures,
                view_formats: &[],
            };
            Ok(Physical::Texture(device.create_texture(&descriptor)))
        }
        ResourceKind::Buffer(_) => {
            let made = buffer::make(device, label, bytes, buffers);
            Ok(Physical::Buffer(made))
        }
        _ => Err(ExecuteError::Internal(
            "only textures and buffers have allocations",
        )),
    }
}

pub(super) fn dimension(is_3d: bool) -> wgpu::TextureDimension {
    if is_3d {
        wgpu::TextureDimension::D3
    } else {
        wgpu::TextureDimension::D2
    }
}

/// Returns the size of this mip of a texture with this number of layers.
pub(crate) fn extent(texture: &Texture, mip: u32, layers: u32) -> wgpu::Extent3d {
    let [width, height] = texture.mip_size(mip);
    wgpu::Extent3d {
        width,
        height,
        depth_or_array_layers: layers,
    }
}

/// Writes the content that the document declares into a constant resource.
fn fill(version: &Physical, resource: &Resource, queue: &wgpu::Queue) {
    match (version, &resource.kind) {
        (Physical::Texture(made), ResourceKind::Texture(texture)) => {
            let picture = texture.picture.as_ref();
            let Some(bytes) = picture.and_then(|picture| picture.bytes(texture.format)) else {
                return;
            };
            let texel = texture.format.block_copy_size(None).unwrap_or(4);
            let layout = wgpu::TexelCopyBufferLayout {
                offset: 0,
                bytes_per_row: Some(texture.size[0] * texel),
                rows_per_image: None,
            };
            queue.write_texture(made.as_image_copy(), &bytes, layout, extent(texture, 0, 1));
        }
        (Physical::Buffer(made), ResourceKind::Buffer(buffer)) => {
            if let Some(content) = &buffer.content {
                queue.write_buffer(made, 0, content);
            }
        }
        _ => {}
    }
}

/// Returns the smaller allocation of a former plan whose content a larger resource with `keep` and
/// `grow` continues.
fn grown(old_plan: &Plan, allocation: &GpuAllocation, resource: &Resource) -> Option<Physical> {
    let goes_on = |it: &Resource| it.keep && it.growth.is_some();
    let former = was(old_plan, resource).filter(|former| goes_on(former) && goes_on(resource))?;
    let [made] = allocation.versions.as_slice() else {
        return None;
    };
    let is_smaller = match (&former.kind, &resource.kind) {
        (ResourceKind::Buffer(before), ResourceKind::Buffer(wanted)) => {
            before.stride == wanted.stride && before.bytes < wanted.bytes
        }
        (ResourceKind::Texture(before), ResourceKind::Texture(wanted)) => {
            let layers = wanted.layers;
            let with_more = Texture {
                layers,
                ..before.clone()
            };
            with_more == *wanted && before.layers < layers
        }
        _ => false,
    };
    is_smaller.then(|| made.clone())
}

/// Returns the resource of the same name in another plan.
fn was<'p>(old_plan: &'p Plan, resource: &Resource) -> Option<&'p Resource> {
    let mut resources = old_plan.resources().iter();
    resources.find(|former| former.name == resource.name)
}

/// Returns true if another plan's resource of the same name holds the same content.
fn holds_the_same(old_plan: &Plan, resource: &Resource) -> bool {
    let former = was(old_plan, resource);
    match former.map(|former| (&former.kind, &resource.kind)) {
        Some((ResourceKind::Texture(a), ResourceKind::Texture(b))) => a == b,
        Some((ResourceKind::Buffer(a), ResourceKind::Buffer(b))) => a == b,
        _ => false,
    }
}

/// Returns true if a texture matches a plan's resource, or a buffer its size in bytes.
fn is_made(physical: &Physical, resource: &Resource, bytes: u64) -> bool {
    match (physical, &resource.kind) {
        (Physical::Texture(made), ResourceKind::Texture(wanted)) => {
            made.format() == wanted.format
                && [made.width(), made.height()] == wanted.size
                && made.mip_level_count() == wanted.mips
                && made.depth_or_array_layers() == wanted.layers
                && made.sample_count() == wanted.samples
                && (made.dimension() == wgpu::TextureDimension::D3) == wanted.is_3d
        }
        (Physical::Buffer(buffer), ResourceKind::Buffer(_)) => buffer.size() == bytes,
        _ => false,
    }
}
