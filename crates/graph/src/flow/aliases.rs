//! Allocations, and the resources that share them. Two resources with equal descriptors take turns
//! in one allocation if the last use of one comes before the first write of the other.

use super::{
    lifetimes::{Lifetime, Lifetimes},
    view::GraphView,
};
use crate::{
    link::pass::{LinkedPass, PassId},
    resource::{Origin, Resource, ResourceId, ResourceKind},
};
use std::collections::{BTreeMap, BTreeSet};

/// One allocation: a texture or buffer on the device, and the resources that use it one after the
/// other in a frame.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Allocation {
    /// Resources that use the allocation, at least one, in the order of their first use in a frame.
    /// Each is first used after the last use of the one before. All have equal sizes, formats and
    /// usages ([`Lifetime`]): the allocation can be created from any of them.
    pub aliases: Vec<ResourceId>,
    /// Position in the schedule of the last use of the last of these resources.
    until: usize,
}

/// Allocations on the device for the textures and buffers of a plan that the host does not make,
/// and the resources that share them.
#[derive(Clone, Debug, Default)]
#[non_exhaustive]
pub struct Aliases {
    /// All allocations, in the order of their first use in a frame. Each texture and buffer that a
    /// [live](crate::Plan::live) pass uses, except the host's, is in exactly one of them. Resources
    /// whose content outlives the frame, is read back, or counts for one that grows share theirs
    /// with no other.
    pub list: Vec<Allocation>,
    /// Index in [`list`](Self::list) of the allocation of each resource. A resource that is not a
    /// key has no allocation: no [live](crate#terms) pass uses it, it is a sampler, the host makes
    /// it, or it is the `.previous` of another ([`Origin::Previous`]), whose allocation it has.
    pub of: BTreeMap<ResourceId, usize>,
}

/// Assigns an allocation to every texture and buffer of the graph with a lifetime.
///
/// Memory is handed on only to a resource whose first use provably overwrites all of it, so that
/// content of the resource before it cannot be read. Resources in `kept` are needed beyond the
/// frame and never share memory.
pub(crate) fn aliases(
    view: GraphView<'_>,
    sequence: &[PassId],
    lifetimes: &Lifetimes,
    kept: &BTreeSet<ResourceId>,
) -> Aliases {
    let mut aliases = Aliases::default();
    // In the order of first uses; resources that start together in the order of the file.
    let mut starts: Vec<(usize, ResourceId)> = lifetimes
        .iter()
        .filter(|(id, _)| {
            let resource = view.resource(**id);
            matches!(resource.origin, Origin::Own | Origin::Constant)
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
            !kept.contains(&id) && overwritten(view.pass(sequence[first]), view.resource(id), id);
        let free = shared.iter().copied().find(|&slot| {
            let slot: &Allocation = &aliases.list[slot];
            let other = slot.aliases[0];
            shares
                && slot.until < first
                && alike(
                    view.resource(other),
                    &lifetimes[&other],
                    view.resource(id),
                    lifetime,
                )
        });
        let slot = free.unwrap_or_else(|| {
            aliases.list.push(Allocation {
                aliases: Vec::new(),
                until: 0,
            });
            aliases.list.len() - 1
        });
        if shares {
            shared.insert(slot);
        }
        aliases.list[slot].aliases.push(id);
        aliases.list[slot].until = lifetime.last;
        aliases.of.insert(id, slot);
    }
    aliases
}

/// True if a pass overwrites all of a resource before it reads any of it.
fn overwritten(pass: &LinkedPass, resource: &Resource, id: ResourceId) -> bool {
    let uses = || {
        pass.accesses
            .iter()
            .filter(move |access| access.resource == id)
    };
    let covers_first = |uses: &mut dyn Iterator<Item = &crate::link::pass::Access>| {
        uses.next()
            .is_some_and(|first| first.fully_overwrites && !first.reads)
    };
    let texture = match &resource.kind {
        ResourceKind::Texture(texture) => texture,
        // Items that are used one by one may not be all there are.
        _ => {
            let whole = uses().all(|access| access.part.items().is_none());
            return whole && covers_first(&mut uses());
        }
    };
    let aspects = [
        wgt::TextureAspect::DepthOnly,
        wgt::TextureAspect::StencilOnly,
    ];
    let aspects = if texture.format.is_combined_depth_stencil_format() {
        &aspects[..]
    } else {
        &aspects[..1]
    };
    let covers = |mip: u32, layer: u32| {
        aspects.iter().all(|aspect| {
            let part = crate::resource::SubresourceRange {
                mips: mip..mip + 1,
                layers: layer..layer + 1,
                aspect: *aspect,
            };
            covers_first(&mut uses().filter(|access| access.part.overlaps(&part)))
        })
    };
    (0..texture.mips).all(|mip| (0..texture.mip_layers(mip)).all(|layer| covers(mip, layer)))
}

/// True if two resources would be created with equal descriptors.
fn alike(a: &Resource, of_a: &Lifetime, b: &Resource, of_b: &Lifetime) -> bool {
    let same = match (&a.kind, &b.kind) {
        (ResourceKind::Texture(a), ResourceKind::Texture(b)) => a == b,
        (ResourceKind::Buffer(a), ResourceKind::Buffer(b)) => a.bytes == b.bytes,
        _ => false,
    };
    same && of_a.textures == of_b.textures && of_a.buffers == of_b.buffers
}
