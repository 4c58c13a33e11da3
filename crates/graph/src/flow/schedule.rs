//! Order of the live passes that respects every dependence. Dependences run from a pass to one
//! behind it in the order that was [derived](super::arrange), so this is that order.

use super::{aliases::Aliases, conditions::Conditions, lifetimes::Lifetimes};
use crate::{link::PassId, resource::ResourceId};
use std::collections::BTreeSet;

/// The [live](crate#terms) passes of a plan in the order in which they run, with the lifetimes, run
/// conditions and allocations that follow from this order.
#[derive(Clone, Debug, Default)]
#[non_exhaustive]
pub struct Schedule {
    /// Ids of the [live](crate::Plan::live) passes in the order in which they run in a frame. A
    /// *position* is an index into this list.
    pub passes: Vec<PassId>,
    /// First use, last use and usages of each resource that a scheduled pass uses.
    pub lifetimes: Lifetimes,
    /// Frames in which each pass runs, and the groups of passes that run or are skipped together.
    pub conditions: Conditions,
    /// Allocations of textures and buffers on the device, and the resources that share each of
    /// them.
    pub aliases: Aliases,
    /// Textures and buffers of the graph that a [live](crate#terms) pass also reads as they were in
    /// the frame before (`.previous`). The device holds two of each, for which
    /// [`aliases`](Self::aliases) has one allocation that no other resource shares. A frame that
    /// runs a writer of the resource writes one and reads the other as `.previous`, and then they
    /// change places. In a frame without its writers both names are the one that was written last.
    pub ping_pong: BTreeSet<ResourceId>,
}

/// Returns the live passes in their order: each depends on passes before it alone.
pub(crate) fn sequence(live: &[bool]) -> Vec<PassId> {
    let passes = (0..live.len()).filter(|pass| live[*pass]);
    passes.map(PassId).collect()
}
