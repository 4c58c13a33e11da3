//! Lifetimes and usages of resources, from the live passes. A resource that none of them uses is
//! never made.

use super::view::GraphView;
use crate::{
    link::pass::{PassId, Usage},
    resource::ResourceId,
};
use std::collections::BTreeMap;

/// The lifetime of every resource that a scheduled pass touches; only those are made.
pub type Lifetimes = BTreeMap<ResourceId, Lifetime>;

/// Uses of one resource by the passes of a schedule.
#[derive(Clone, Debug)]
pub struct Lifetime {
    /// Usages of a texture.
    pub textures: wgt::TextureUsages,
    /// Usages of a buffer.
    pub buffers: wgt::BufferUsages,
    /// Position in the schedule of the first pass that uses it.
    pub first: usize,
    /// Position of the last one.
    pub last: usize,
}

/// Only resources that a scheduled pass touches have a lifetime, and only those are made.
pub(crate) fn lifetimes(view: GraphView<'_>, sequence: &[PassId]) -> Lifetimes {
    let mut lifetimes = Lifetimes::new();
    for (at, &pass) in sequence.iter().enumerate() {
        for access in &view.pass(pass).accesses {
            let lifetime = lifetimes.entry(access.resource).or_insert(Lifetime {
                textures: wgt::TextureUsages::empty(),
                buffers: wgt::BufferUsages::empty(),
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
