//! Allocations, and the resources that share them. Two textures with equal descriptors take turns
//! in one allocation; buffers of any size lie at places of one, those that are needed at the same
//! time apart.

use super::lifetimes::Lifetimes;
use super::placing::{ALIGNMENT, Candidate, Placing, Slot, candidates};
use super::view::GraphView;
use crate::link::{Access, LinkedPass, PassId};
use crate::resource::{Resource, ResourceId, ResourceKind, SubresourceRange};
use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;
use wgt::TextureAspect;

/// One allocation: a texture or buffer on the device, and the resources that use it in a frame.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Allocation {
    /// Resources that use the allocation, at least one, in the order of their first use in a frame.
    /// Textures have equal descriptors, and each is first used after the last use of the one
    /// before; the allocation can be created from any of them. Buffers lie at the places that
    /// [`Aliases::places`] tells.
    pub aliases: Vec<ResourceId>,
    /// Size of the texture or buffer in bytes, without padding that a driver adds.
    pub bytes: u64,
    /// Usages that the allocation must be created with on the device if it is a buffer: those of
    /// all its resources.
    pub buffers: wgt::BufferUsages,
}

/// Reason for which a resource shares memory with no other.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Alone {
    /// Its content is read back, in a later frame, or by the host.
    OutlivesFrame,
    /// Its number of items or layers grows between frames.
    Grows,
    /// Nothing proves that its first use in a frame overwrites all of it.
    WrittenInPart,
    /// Every other resource that could share is used while this one is needed.
    Overlaps,
    /// It takes less than 256 bytes, and no other buffer of its size and usage could share.
    Small,
    /// Every other resource with free memory is used by one of the steps that use this one, or has
    /// its clear encoded ahead of them.
    UsedTogether,
    /// No other texture that could share has this size, format and usage.
    OneOfItsKind,
}

impl Alone {
    /// Returns the reason of a resource that could share; `is_apart` tells if another one is never
    /// needed at the same time.
    fn among_others(resource: &Resource, is_apart: bool) -> Self {
        match &resource.kind {
            _ if !is_apart => Self::Overlaps,
            ResourceKind::Texture(_) => Self::OneOfItsKind,
            kind if kind.bytes() < ALIGNMENT => Self::Small,
            _ => Self::UsedTogether,
        }
    }

    /// Returns the reason in two or three words, for tables.
    pub fn text(self) -> &'static str {
        match self {
            Self::OutlivesFrame => "outlives the frame",
            Self::Grows => "grows",
            Self::WrittenInPart => "may be written in part",
            Self::Overlaps => "overlaps all others",
            Self::Small => "small",
            Self::UsedTogether => "used together",
            Self::OneOfItsKind => "one of its kind",
        }
    }
}

/// Allocations on the device for the textures and buffers of a plan that the host does not make,
/// and the resources that share them.
#[derive(Clone, Debug, Default)]
#[non_exhaustive]
pub struct Aliases {
    /// All allocations, in the order of their first use in a frame. Each texture and buffer that a
    /// [live](crate::Plan::live) pass uses, except the host's, is in exactly one of them. Resources
    /// whose content outlives the frame, is read back, or counts for one that grows share theirs
    /// with no other, nor do those that grow.
    pub list: Vec<Allocation>,
    /// Index in [`list`](Self::list) of the allocation of each resource. A resource that is not a
    /// key has no allocation: no [live](crate#terms) pass uses it, it is a sampler, the host makes
    /// it, or it is the `.previous` of another ([`Previous`](crate::Origin::Previous)), whose
    /// allocation it has.
    pub of: BTreeMap<ResourceId, usize>,
    /// Bytes of its allocation that each resource of [`of`](Self::of) has. Two that overlap are not
    /// needed at the same time.
    pub places: BTreeMap<ResourceId, Range<u64>>,
    /// Reason for which a resource of [`of`](Self::of) has an allocation of its own.
    pub alone: BTreeMap<ResourceId, Alone>,
}

impl Aliases {
    /// Returns true if two resources have bytes of one allocation in common.
    pub fn overlap(&self, a: ResourceId, b: ResourceId) -> bool {
        let place = |id| Some((self.of.get(&id)?, self.places.get(&id)?));
        place(a)
            .zip(place(b))
            .is_some_and(|((a, one), (b, other))| {
                a == b && one.start < other.end && other.start < one.end
            })
    }
}

/// Assigns an allocation to every texture and buffer of the graph with a lifetime.
///
/// Memory is handed on only to a resource whose first use provably overwrites all of it, so that
/// content of the resource before it cannot be read. Resources in `kept` are needed beyond the
/// frame and never share memory. No buffer becomes larger than `largest` bytes by sharing.
pub(crate) fn aliases(
    view: GraphView<'_>,
    sequence: &[PassId],
    lifetimes: &Lifetimes,
    kept: &BTreeSet<ResourceId>,
    largest: u64,
) -> Aliases {
    let placing = Placing::new(view, sequence, largest);
    let mut alone = BTreeMap::new();
    let (mut slots, mut textures, mut buffers) = (Vec::new(), Vec::new(), Vec::new());
    for candidate in candidates(view, sequence, lifetimes) {
        let (id, resource) = (candidate.id, candidate.resource);
        let first = view.pass(sequence[candidate.lifetime.first]);
        let reason = if kept.contains(&id) {
            Alone::OutlivesFrame
        } else if resource.growth.is_some() {
            Alone::Grows
        } else if !overwritten(first, resource, id) {
            Alone::WrittenInPart
        } else if matches!(resource.kind, ResourceKind::Texture(_)) {
            textures.push(candidate);
            continue;
        } else {
            buffers.push(candidate);
            continue;
        };
        alone.insert(id, reason);
        slots.push(Slot::new(candidate));
    }
    textures.sort_by_key(|candidate| candidate.lifetime.first);
    for shared in [placing.placed(&textures), placing.best(buffers)] {
        let members = || shared.iter().flat_map(|slot| &slot.members);
        for slot in &shared {
            if let [(candidate, _)] = &slot.members[..] {
                let mut members = members();
                let is_apart = members.any(|(other, _)| candidate.is_apart(other));
                alone.insert(
                    candidate.id,
                    Alone::among_others(candidate.resource, is_apart),
                );
            }
        }
        slots.extend(shared);
    }
    collected(slots, alone)
}

/// Returns the allocations in the order of their first use.
fn collected(mut slots: Vec<Slot<'_>>, alone: BTreeMap<ResourceId, Alone>) -> Aliases {
    let start = |(candidate, _): &(Candidate<'_>, u64)| (candidate.lifetime.first, candidate.id);
    for slot in &mut slots {
        slot.members.sort_by_key(start);
    }
    slots.sort_by_key(|slot| slot.members.first().map(start));
    let mut aliases = Aliases {
        alone,
        ..Aliases::default()
    };
    for slot in slots {
        let mut buffers = wgt::BufferUsages::empty();
        for (candidate, at) in &slot.members {
            buffers |= candidate.lifetime.buffers;
            aliases.of.insert(candidate.id, aliases.list.len());
            let place = *at..*at + candidate.bytes;
            aliases.places.insert(candidate.id, place);
        }
        aliases.list.push(Allocation {
            aliases: slot
                .members
                .iter()
                .map(|(candidate, _)| candidate.id)
                .collect(),
            bytes: slot.bytes,
            buffers,
        });
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
    let covers_first = |uses: &mut dyn Iterator<Item = &Access>| {
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
    let mut aspects = vec![TextureAspect::DepthOnly];
    if texture.format.is_combined_depth_stencil_format() {
        aspects.push(TextureAspect::StencilOnly);
    }
    let covers = |mip: u32, layer: u32| {
        aspects.iter().all(|aspect| {
            let part = SubresourceRange {
                mips: mip..mip + 1,
                layers: layer..layer + 1,
                aspect: *aspect,
            };
            covers_first(&mut uses().filter(|access| access.part.overlaps(&part)))
        })
    };
    (0..texture.mips).all(|mip| (0..texture.mip_layers(mip)).all(|layer| covers(mip, layer)))
}
