//! Phase 8, second half: which resources share memory. Two that have equal descriptors, and of which one is not needed any
//! more when the other is first written, take turns in one allocation.

use crate::{
    lifetime::Lifetime,
    link::LinkedPass,
    resolve::{Origin, Resource, ResourceId, ResourceKind},
};
use std::collections::{BTreeMap, BTreeSet};

/// One allocation and the resources that take turns in it, in the order in which they are written.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Slot {
    pub tenants: Vec<ResourceId>,
    /// Position in the schedule of the last use of the last tenant.
    until: usize,
}

/// All allocations of a plan.
#[derive(Clone, Debug, Default)]
pub(crate) struct Slots {
    pub list: Vec<Slot>,
    pub of: BTreeMap<ResourceId, usize>,
}

/// Bytes that a resource takes.
pub(crate) fn bytes(resource: &Resource) -> u64 {
    match &resource.kind {
        ResourceKind::Texture(texture) => texture.bytes(),
        ResourceKind::Buffer(buffer) => buffer.bytes,
        _ => 0,
    }
}

/// Gives every own texture and buffer with a lifetime its allocation.
///
/// Memory is handed on only to a resource whose first use provably overwrites all of it: what is left of another's content can
/// then not be read. `kept` ones are needed beyond the frame and have memory of their own.
pub(crate) fn slots(
    passes: &[LinkedPass],
    schedule: &[usize],
    resources: &[Resource],
    lifetimes: &BTreeMap<ResourceId, Lifetime>,
    kept: &BTreeSet<ResourceId>,
) -> Slots {
    let mut slots = Slots::default();
    // In the order of first uses; resources that start together in the order of the file.
    let mut starts: Vec<(usize, ResourceId)> = lifetimes
        .iter()
        .filter(|(id, _)| {
            let resource = &resources[id.0];
            resource.origin == Origin::Own
                && matches!(
                    resource.kind,
                    ResourceKind::Texture(_) | ResourceKind::Buffer(_)
                )
        })
        .map(|(id, lifetime)| (lifetime.first, *id))
        .collect();
    starts.sort();
    let mut shared: BTreeSet<usize> = BTreeSet::new();
    for (first, id) in starts {
        let lifetime = &lifetimes[&id];
        let shares =
            !kept.contains(&id) && overwritten(&passes[schedule[first]], &resources[id.0], id);
        let free = shared.iter().copied().find(|&slot| {
            let slot: &Slot = &slots.list[slot];
            let tenant = slot.tenants[0];
            shares
                && slot.until < first
                && alike(
                    &resources[tenant.0],
                    &lifetimes[&tenant],
                    &resources[id.0],
                    lifetime,
                )
        });
        let slot = free.unwrap_or_else(|| {
            slots.list.push(Slot {
                tenants: Vec::new(),
                until: 0,
            });
            slots.list.len() - 1
        });
        if shares {
            shared.insert(slot);
        }
        slots.list[slot].tenants.push(id);
        slots.list[slot].until = lifetime.last;
        slots.of.insert(id, slot);
    }
    slots
}

/// Whether a pass overwrites everything of a resource before it reads any of it.
fn overwritten(pass: &LinkedPass, resource: &Resource, id: ResourceId) -> bool {
    let (mips, layers) = match &resource.kind {
        ResourceKind::Texture(texture) => (texture.mips, texture.layers),
        _ => (1, 1),
    };
    let cell = |mip: u32, layer: u32| {
        let mut uses = pass.accesses.iter().filter(|access| {
            access.resource == id
                && access.part.mips.contains(&mip)
                && access.part.layers.contains(&layer)
        });
        uses.next()
            .is_some_and(|first| first.covers && !first.reads)
    };
    (0..mips).all(|mip| (0..layers).all(|layer| cell(mip, layer)))
}

/// Whether two resources would be made the same way.
fn alike(a: &Resource, of_a: &Lifetime, b: &Resource, of_b: &Lifetime) -> bool {
    let same = match (&a.kind, &b.kind) {
        (ResourceKind::Texture(a), ResourceKind::Texture(b)) => a == b,
        (ResourceKind::Buffer(a), ResourceKind::Buffer(b)) => a.bytes == b.bytes,
        _ => false,
    };
    same && of_a.textures == of_b.textures && of_a.buffers == of_b.buffers
}
