//! Checks the host's imports against their declarations, and which device they are on.

use super::{allocation::dimension, physical::Physical};
use crate::identity::{has_buffer, hears};
use skiagraph_graph::Import;

/// Returns true if the memory of a resource is on a device. wgpu does not tell that of samplers and
/// acceleration structures, which count as such.
pub(crate) fn is_on(device: &wgpu::Device, physical: &Physical) -> bool {
    match physical {
        Physical::Texture(texture) => {
            let beyond = wgpu::TextureViewDescriptor {
                base_mip_level: u32::MAX,
                ..wgpu::TextureViewDescriptor::default()
            };
            hears(device, || drop(texture.create_view(&beyond)))
        }
        Physical::Buffer(buffer) => has_buffer(device, buffer),
        Physical::Sampler(_) | Physical::AccelerationStructure(_) | Physical::CpuWork(_) => true,
    }
}

/// Says how a texture, buffer or sampler differs from its description as an import; `None` if it
/// matches. It may have more usages than described.
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
                is_3d,
                samples,
                usage,
                ..
            },
        ) => {
            let own_layers = texture.depth_or_array_layers();
            vec![
                unless("its format", format, texture.format()),
                unless("its size", size, [texture.width(), texture.height()]),
                unless("its number of mips", mips, texture.mip_level_count()),
                unless("its number of layers", layers, own_layers),
                unless("its dimension", dimension(is_3d), texture.dimension()),
                unless("its number of samples", samples, texture.sample_count()),
                unless("its usage", usage, texture.usage() & usage),
            ]
        }
        (Physical::Buffer(buffer), Import::Buffer { bytes, usage, .. }) => vec![
            unless("its size in bytes", bytes, buffer.size()),
            unless("its usage", usage, buffer.usage() & usage),
        ],
        (Physical::Sampler(_), Import::Sampler { .. }) => Vec::new(),
        (physical, described) => {
            let is = match physical {
                Physical::Texture(_) => "a texture",
                Physical::Buffer(_) => "a buffer",
                Physical::Sampler(_) => "a sampler",
                Physical::AccelerationStructure(_) => "an acceleration structure",
                Physical::CpuWork(_) => "work for the CPU",
            };
            let planned = match described {
                Import::Texture { .. } => "a texture",
                Import::Buffer { .. } => "a buffer",
                Import::Sampler { .. } => "a sampler",
            };
            vec![Some(format!("it is {is}, not {planned}"))]
        }
    };
    let differences: Vec<String> = differences.into_iter().flatten().collect();
    (!differences.is_empty()).then(|| differences.join("; "))
}
