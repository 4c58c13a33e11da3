//! Attachments whose content nothing needs after the pass that draws to them.

use super::{aliases::Alone, schedule::Schedule, view::GraphView};
use crate::link::{Access, Usage};
use crate::resource::{Origin, ResourceId, SubresourceRange, Target};

/// Returns the attachments of the pass at position `at` that a device need not store: nothing uses
/// them after the only step of the pass that does, and their memory is cleared as an attachment
/// before it is used again. A device would fill the memory first for any other use.
pub(crate) fn discarded(view: GraphView<'_>, schedule: &Schedule, at: usize) -> Vec<Target> {
    let attachment = |access: &&Access| access.writes && is_attachment(access);
    let drawn = view
        .pass(schedule.passes[at])
        .accesses
        .iter()
        .filter(attachment);
    let drawn = drawn.filter(|access| {
        let (id, part) = (access.resource, &access.part);
        let uses = uses(view, schedule, id, part);
        let mut last = uses.into_iter().skip_while(|(position, _)| *position < at);
        let outlives = schedule.aliases.alone.get(&id) == Some(&Alone::OutlivesFrame);
        view.resource(id).origin == Origin::Own
            && !outlives
            && last.next().is_some()
            && last.next().is_none()
            && begins_cleared(view, schedule, id, part)
    });
    let target = |access: &Access| Target {
        id: access.resource,
        part: access.part.clone(),
    };
    drawn.map(target).collect()
}

fn is_attachment(access: &Access) -> bool {
    access.usage == Usage::Texture(wgt::TextureUsages::RENDER_ATTACHMENT)
}

/// Returns the uses of a part of a resource in a frame, each with its position.
fn uses<'p>(
    view: GraphView<'p>,
    schedule: &Schedule,
    id: ResourceId,
    part: &SubresourceRange,
) -> Vec<(usize, &'p Access)> {
    let lifetime = &schedule.lifetimes[&id];
    let positions = lifetime.first..=lifetime.last;
    let uses = positions.flat_map(|at| {
        let accesses = view.pass(schedule.passes[at]).accesses.iter();
        accesses.map(move |access| (at, access))
    });
    let uses = uses.filter(|(_, it)| it.resource == id && it.part.overlaps(part));
    uses.collect()
}

/// True if every resource with the memory of `id` begins with a clear of this part as an
/// attachment.
fn begins_cleared(
    view: GraphView<'_>,
    schedule: &Schedule,
    id: ResourceId,
    part: &SubresourceRange,
) -> bool {
    let slot = schedule.aliases.of.get(&id);
    let aliases = slot.map_or(&[][..], |slot| &schedule.aliases.list[*slot].aliases);
    aliases.iter().all(|alias| {
        let first = uses(view, schedule, *alias, part).into_iter().next();
        first.is_none_or(|(_, it)| is_attachment(it) && it.fully_overwrites && !it.reads)
    })
}
