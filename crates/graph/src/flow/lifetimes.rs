//! Lifetimes and usages of resources, from the live passes. A resource that no live pass uses is
//! never created.

use super::view::GraphView;
use crate::link::{PassId, Usage};
use crate::resource::ResourceId;
use std::collections::BTreeMap;

/// Lifetimes in a frame, by resource. Only resources of which a scheduled pass uses the content of
/// this frame or of the frame before are listed, the host's among them; only these are created on
/// the device, or asked of the host. The `.previous` of a resource
/// ([`Origin::Previous`](crate::Origin::Previous)) has an entry of its own.
pub type Lifetimes = BTreeMap<ResourceId, Lifetime>;

/// First and last use of one resource in a schedule, and the usages to create it with on the
/// device.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Lifetime {
    /// Usages that the resource must be created with on the device if it is a texture; without
    /// meaning for other resources.
    pub textures: wgt::TextureUsages,
    /// Usages that the resource must be created with on the device if it is a buffer; without
    /// meaning for other resources.
    pub buffers: wgt::BufferUsages,
    /// Index in [`Schedule::passes`](crate::Schedule::passes) of the first pass of a frame that
    /// uses the resource.
    pub first: usize,
    /// Index in [`Schedule::passes`](crate::Schedule::passes) of the last pass of a frame that uses
    /// the resource, that pass included.
    pub last: usize,
}

/// Finds the lifetime of every resource that a pass of the sequence uses.
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
