//! Memory filled with a pattern before a resource is first used in a frame. What then reads something that it has not written
//! reads the pattern, and outputs differ between two patterns.

use super::{
    ExecuteError,
    encode::{depth_attachment, render_pass},
    error::scoped,
};
use crate::{
    allocate::Binder,
    memory::{Histories, Memory, Versions},
    plan::Plan,
    resolve::{Origin, Part, ResourceId, ResourceKind, Target},
};

/// Fills by position in the schedule; of a resource with a history one for each of its allocations.
pub(super) struct Poison {
    pattern: wgpu::Buffer,
    fills: Vec<(usize, ResourceId, Vec<Fill>)>,
}

enum Fill {
    Buffer(wgpu::Buffer),
    /// Texture, bytes of a row and size of each mip.
    Texture(wgpu::Texture, Vec<(u32, wgpu::Extent3d)>),
    Depth(Vec<wgpu::TextureView>, f32),
}

impl Poison {
    /// `None` if the plan asks for none. What outlives the frame is not filled; of a resource with a history that is last frame's
    /// version, while what is written holds what is left of the frame before that one.
    pub fn new(
        plan: &Plan,
        memory: &Memory,
        device: &wgpu::Device,
    ) -> Result<Option<Self>, ExecuteError> {
        let Some(byte) = plan.request.poison else {
            return Ok(None);
        };
        let (mut fills, mut most) = (Vec::new(), 4);
        for (&id, lifetime) in &plan.lifetimes {
            let resource = &plan.resources[id.0];
            let outlives = plan.conditions.kept.contains(&id) && plan.versions(id) == 1;
            if resource.origin != Origin::Own || outlives {
                continue;
            }
            let mut fill = |histories: &Histories| -> Result<Option<Fill>, ExecuteError> {
                let binder = Binder {
                    device,
                    memory,
                    histories,
                };
                Ok(Some(match &resource.kind {
                    ResourceKind::Buffer(buffer) => {
                        most = most.max(buffer.bytes);
                        Fill::Buffer(memory.buffer(id, histories)?.clone())
                    }
                    ResourceKind::Texture(texture) if texture.format.is_depth_stencil_format() => {
                        let part = Part {
                            mips: 0..texture.mips,
                            layers: 0..texture.layers,
                        };
                        Fill::Depth(
                            binder.single_views(&Target { id, part })?,
                            f32::from(byte) / 255.0,
                        )
                    }
                    ResourceKind::Texture(texture) => {
                        let texel = texture.format.block_copy_size(None).unwrap_or(4);
                        let mip = |mip: u32| {
                            let [width, height] = texture.size.map(|edge| (edge >> mip).max(1));
                            let row = (width * texel)
                                .next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
                            let extent = wgpu::Extent3d {
                                width,
                                height,
                                depth_or_array_layers: 1,
                            };
                            (row, extent)
                        };
                        let mips: Vec<_> = (0..texture.mips).map(mip).collect();
                        let bytes = mips
                            .iter()
                            .map(|(row, size)| u64::from(*row) * u64::from(size.height));
                        most = bytes.fold(most, u64::max);
                        Fill::Texture(memory.texture(id, histories)?.clone(), mips)
                    }
                    _ => return Ok(None),
                }))
            };
            let states = (0..plan.versions(id)).map(|current| {
                let versions = Versions {
                    current,
                    previous: current,
                };
                Histories::from([(id, versions)])
            });
            let made: Vec<Fill> = states
                .filter_map(|histories| fill(&histories).transpose())
                .collect::<Result<_, _>>()?;
            fills.push((lifetime.first, id, made));
        }
        let pattern = scoped(device, "pattern", || {
            device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("pattern"),
                size: most,
                usage: wgpu::BufferUsages::COPY_SRC,
                mapped_at_creation: true,
            })
        })?;
        match pattern.get_mapped_range_mut(..) {
            Ok(mut mapped) => mapped.copy_from_slice(&vec![byte; most as usize]),
            Err(_) => return Err(ExecuteError::Internal("the pattern could not be uploaded")),
        }
        pattern.unmap();
        Ok(Some(Self { pattern, fills }))
    }

    /// Fills what the pass at `at` is the first to use.
    pub fn fill(&self, at: usize, histories: &Histories, encoder: &mut wgpu::CommandEncoder) {
        for (_, id, fills) in self.fills.iter().filter(|(first, ..)| *first == at) {
            let current = histories.get(id).map_or(0, |versions| versions.current);
            let Some(fill) = fills.get(current) else {
                continue;
            };
            match fill {
                Fill::Buffer(buffer) => {
                    encoder.copy_buffer_to_buffer(&self.pattern, 0, buffer, 0, buffer.size());
                }
                Fill::Texture(texture, mips) => {
                    for layer in 0..texture.depth_or_array_layers() {
                        for (mip_level, (row, size)) in (0u32..).zip(mips) {
                            encoder.copy_buffer_to_texture(
                                wgpu::TexelCopyBufferInfo {
                                    buffer: &self.pattern,
                                    layout: wgpu::TexelCopyBufferLayout {
                                        offset: 0,
                                        bytes_per_row: Some(*row),
                                        rows_per_image: None,
                                    },
                                },
                                wgpu::TexelCopyTextureInfo {
                                    texture,
                                    mip_level,
                                    origin: wgpu::Origin3d {
                                        x: 0,
                                        y: 0,
                                        z: layer,
                                    },
                                    aspect: wgpu::TextureAspect::All,
                                },
                                *size,
                            );
                        }
                    }
                }
                Fill::Depth(views, value) => {
                    for view in views {
                        let depth = depth_attachment(view, Some(*value), true);
                        render_pass("pattern", encoder, &[], Some(depth), None);
                    }
                }
            }
        }
    }
}
