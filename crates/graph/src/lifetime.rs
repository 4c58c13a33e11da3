//! Phase 8: what the live passes use each resource for; what none of them uses is never made.

use crate::{
    link::{LinkedPass, Usage},
    resolve::ResourceId,
};
use std::collections::BTreeMap;

/// Uses of one resource by the passes of a schedule.
#[derive(Clone, Debug)]
pub(crate) struct Lifetime {
    pub textures: wgpu::TextureUsages,
    pub buffers: wgpu::BufferUsages,
    /// Position in the schedule of the first pass that uses it.
    pub first: usize,
    /// Position of the last one.
    pub last: usize,
}

/// Only resources that a scheduled pass touches have a lifetime, and only those are made.
pub(crate) fn lifetimes(
    passes: &[LinkedPass],
    schedule: &[usize],
) -> BTreeMap<ResourceId, Lifetime> {
    let mut lifetimes: BTreeMap<ResourceId, Lifetime> = BTreeMap::new();
    for (at, &pass) in schedule.iter().enumerate() {
        for access in &passes[pass].accesses {
            let lifetime = lifetimes.entry(access.resource).or_insert(Lifetime {
                textures: wgpu::TextureUsages::empty(),
                buffers: wgpu::BufferUsages::empty(),
                first: at,
                last: at,
            });
            lifetime.last = at;
            match access.usage {
                Usage::Texture(usage) => lifetime.textures |= usage,
                Usage::Buffer(usage) => lifetime.buffers |= usage,
                Usage::None => {}
            }
        }
    }
    lifetimes
}
