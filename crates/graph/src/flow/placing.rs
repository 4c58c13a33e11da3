//! Places of resources in allocations: who may share, and where.

use super::lifetimes::{Lifetime, Lifetimes};
use super::view::GraphView;
use crate::instantiate::Run;
use crate::kinds::Step;
use crate::link::PassId;
use crate::resource::{Origin, Resource, ResourceId, ResourceKind};
use std::collections::BTreeMap;

/// Every place of a buffer in an allocation is a multiple of this number of bytes: the greatest
/// alignment that a device may ask for in bindings.
pub(super) const ALIGNMENT: u64 = 256;

/// A texture or buffer of the graph that needs memory.
#[derive(Clone)]
pub(super) struct Candidate<'p> {
    pub id: ResourceId,
    pub resource: &'p Resource,
    pub lifetime: &'p Lifetime,
    pub bytes: u64,
    /// Steps that use it: the position of the pass, and the index of the step.
    steps: Vec<(usize, usize)>,
    /// True if its first use in the frame is a clear.
    is_cleared: bool,
}

impl Candidate<'_> {
    /// True if two resources are never needed at the same time.
    pub fn is_apart(&self, other: &Self) -> bool {
        self.lifetime.last < other.lifetime.first || other.lifetime.last < self.lifetime.first
    }

    /// True if two resources would be created with equal descriptors.
    fn is_alike(&self, other: &Self) -> bool {
        let same = match (&self.resource.kind, &other.resource.kind) {
            (ResourceKind::Texture(a), ResourceKind::Texture(b)) => a == b,
            (ResourceKind::Buffer(_), ResourceKind::Buffer(_)) => self.bytes == other.bytes,
            _ => false,
        };
        let usages = |it: &Self| (it.lifetime.textures, it.lifetime.buffers);
        same && usages(self) == usages(other)
    }

    /// True if both resources may be in one texture or buffer. A device knows the usage of a buffer
    /// as a whole, so no step may use both; a few bytes are not worth the usages of another buffer.
    fn may_join(&self, other: &Self) -> bool {
        let is_small = self.bytes.min(other.bytes) < ALIGNMENT;
        match &self.resource.kind {
            ResourceKind::Buffer(_) if !is_small => {
                let mut steps = self.steps.iter();
                self.is_apart(other) || !steps.any(|step| other.steps.contains(step))
            }
            _ => self.is_alike(other) && self.is_apart(other),
        }
    }
}

/// Returns the textures and buffers of the graph with a lifetime.
pub(super) fn candidates<'p>(
    view: GraphView<'p>,
    sequence: &[PassId],
    lifetimes: &'p Lifetimes,
) -> Vec<Candidate<'p>> {
    let own = lifetimes.iter().filter_map(|(&id, lifetime)| {
        let resource = view.resource(id);
        let is_made = matches!(
            resource.kind,
            ResourceKind::Texture(_) | ResourceKind::Buffer(_)
        );
        let is_own = matches!(resource.origin, Origin::Own | Origin::Constant);
        (is_own && is_made).then(|| {
            let candidate = Candidate {
                id,
                resource,
                lifetime,
                bytes: resource.kind.bytes(),
                steps: Vec::new(),
                is_cleared: false,
            };
            (id, candidate)
        })
    });
    let mut own: BTreeMap<ResourceId, Candidate<'p>> = own.collect();
    for (at, &pass) in sequence.iter().enumerate() {
        let pass = view.pass(pass);
        for access in &pass.accesses {
            let Some(candidate) = own.get_mut(&access.resource) else {
                continue;
            };
            let is_clear = matches!(pass.steps.get(access.step), Some(Step::Clear { .. }));
            candidate.is_cleared |= candidate.steps.is_empty() && is_clear;
            candidate.steps.push((at, access.step));
        }
    }
    own.into_values().collect()
}

/// An allocation in the making: its resources, each with its place in bytes, and its size.
pub(super) struct Slot<'p> {
    pub members: Vec<(Candidate<'p>, u64)>,
    pub bytes: u64,
}

impl<'p> Slot<'p> {
    pub fn new(candidate: Candidate<'p>) -> Self {
        Self {
            bytes: candidate.bytes,
            members: vec![(candidate, 0)],
        }
    }
}

/// Sort key of a buffer.
type Key<'k> = dyn Fn(&Candidate<'_>) -> (u64, u64) + 'k;

/// Most buffers for which several orders of placing are tried, each of which takes time by the
/// square of their number.
const TRIED: usize = 128;

/// Places resources in allocations.
pub(super) struct Placing {
    /// For each position the number of passes up to there that end a compute pass in every frame.
    ends: Vec<usize>,
    /// Greatest size of a buffer in bytes.
    largest: u64,
}

impl Placing {
    pub fn new(view: GraphView<'_>, sequence: &[PassId], largest: u64) -> Self {
        let computes = |step: &Step<_>| matches!(step, Step::Dispatch(_) | Step::Clear { .. });
        let ends = sequence.iter().scan(0, |ends, &pass| {
            let pass = view.pass(pass);
            *ends += usize::from(pass.run == Run::Always && !pass.steps.iter().all(computes));
            Some(*ends)
        });
        Self {
            ends: ends.collect(),
            largest,
        }
    }

    /// Places buffers in the order that takes the least memory of some: the large first, as they
    /// come, those that are large for long, or those that are needed when most is.
    pub fn best<'p>(&self, mut buffers: Vec<Candidate<'p>>) -> Vec<Slot<'p>> {
        let mut needed = vec![0u64; self.ends.len()];
        for buffer in &buffers {
            for sum in &mut needed[buffer.lifetime.first..=buffer.lifetime.last] {
                *sum = sum.saturating_add(buffer.bytes);
            }
        }
        let peak = (0..needed.len()).max_by_key(|at| needed[*at]).unwrap_or(0);
        let smallness = |it: &Candidate<'_>| u64::MAX - it.bytes;
        let distance = |it: &Candidate<'_>| {
            let before = it.lifetime.first.saturating_sub(peak);
            before.max(peak.saturating_sub(it.lifetime.last)) as u64
        };
        let briefness = |it: &Candidate<'_>| {
            let length = (it.lifetime.last + 1 - it.lifetime.first) as u64;
            u64::MAX - it.bytes.saturating_mul(length)
        };
        let start = |it: &Candidate<'_>| it.lifetime.first as u64;
        let orders: [&Key<'_>; 4] = [
            &|it| (smallness(it), start(it)),
            &|it| (start(it), smallness(it)),
            &|it| (briefness(it), start(it)),
            &|it| (distance(it), smallness(it)),
        ];
        let tried = if buffers.len() > TRIED {
            1
        } else {
            orders.len()
        };
        let placed = orders[..tried].iter().map(|order| {
            buffers.sort_by_key(|buffer| (order(buffer), buffer.id));
            self.placed(&buffers)
        });
        let total = |slots: &Vec<Slot<'_>>| {
            let bytes = slots.iter().map(|slot| slot.bytes);
            bytes.fold(0, u64::saturating_add)
        };
        placed.min_by_key(total).unwrap_or_default()
    }

    /// Places resources one after the other, each in the allocation that grows least by it, or in
    /// one of its own if that takes no more.
    pub fn placed<'p>(&self, candidates: &[Candidate<'p>]) -> Vec<Slot<'p>> {
        let mut slots: Vec<Slot<'p>> = Vec::new();
        for candidate in candidates {
            let places = slots.iter().enumerate().filter_map(|(index, slot)| {
                let at = self.room(candidate, slot)?;
                let end = slot.bytes.max(at.saturating_add(candidate.bytes));
                let fits = end == slot.bytes || end <= self.largest;
                let more = end - slot.bytes;
                (fits && more < candidate.bytes.max(1)).then_some((more, index, at))
            });
            match places.min() {
                Some((more, index, at)) => {
                    slots[index].members.push((candidate.clone(), at));
                    slots[index].bytes += more;
                }
                None => slots.push(Slot::new(candidate.clone())),
            }
        }
        slots
    }

    /// Returns the first place in an allocation with room for a resource, at its end if need be;
    /// `None` if it may not be there at all.
    fn room(&self, candidate: &Candidate<'_>, slot: &Slot<'_>) -> Option<u64> {
        let mut members = slot.members.iter();
        if !members.all(|(other, _)| candidate.may_join(other)) {
            return None;
        }
        let members = slot.members.iter();
        let taken = members.filter(|(other, _)| !self.may_overlap(candidate, other));
        let mut taken: Vec<(u64, u64)> = taken.map(|(other, at)| (*at, at + other.bytes)).collect();
        taken.sort_unstable();
        let mut room = 0;
        for (start, end) in taken {
            if room + candidate.bytes <= start {
                break;
            }
            room = room.max(end.next_multiple_of(ALIGNMENT));
        }
        Some(room)
    }

    /// True if two resources are never needed at the same time, and no clear of the later one waits
    /// for the other that would else be encoded ahead of the compute pass around both.
    fn may_overlap(&self, a: &Candidate<'_>, b: &Candidate<'_>) -> bool {
        let (before, later) = if a.lifetime.first < b.lifetime.first {
            (a, b)
        } else {
            (b, a)
        };
        let is_within = || {
            let start = before.lifetime.last.checked_sub(1);
            self.ends[later.lifetime.first] == start.map_or(0, |at| self.ends[at])
        };
        a.is_apart(b) && (!later.is_cleared || a.is_alike(b) || !is_within())
    }
}
