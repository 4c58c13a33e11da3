//! Origin, layout and extent of the content of an output or capture, which a reader of the content
//! needs.

use crate::kinds::Step;
use crate::link::{Access, BindTarget, Ids, LinkedPass};
use crate::resource::{Resource, ResourceId, ResourceKind, Target};
use crate::shader::Item;
use crate::shader::items::item;
use std::{collections::BTreeSet, ops::Range};

/// Mips, layers or [items](crate#terms) that an output or [capture](crate#terms) holds of a texture
/// or buffer, as ranges whose ends are excluded, and their numbers in the whole texture or buffer.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PartSummary {
    /// Range of mip levels that the output or [capture](crate#terms) holds, counted from 0, the end
    /// excluded; `0..1` for a buffer.
    pub mips: Range<u32>,
    /// Range of array layers, of slices of a 3D texture, or of items of a buffer that the output or
    /// [capture](crate#terms) holds, counted from 0, the end excluded. It ends at `u32::MAX` for a
    /// whole buffer whose document gives no `count`.
    pub layers: Range<u32>,
    /// Number of mips of the whole texture or buffer (1 for a buffer), then its number of layers,
    /// slices or [items](crate#terms). The second number is `u32::MAX` for a buffer whose document
    /// gives no `count`.
    pub of: [u32; 2],
}

impl PartSummary {
    /// True if the output or [capture](crate#terms) holds less than the whole texture or buffer.
    pub fn is_less(&self) -> bool {
        (self.mips.len(), self.layers.len()) != (self.of[0] as usize, self.of[1] as usize)
    }
}

/// Returns the names of the provided resources that are bound by the passes that write a target.
pub(super) fn provided_behind<'p>(
    live: impl Iterator<Item = &'p LinkedPass> + Clone,
    target: &Target,
    resources: &'p [Resource],
) -> BTreeSet<&'p str> {
    let origin = origin(live.clone(), target);
    let writes = |access: &Access| access.writes && access.resource == origin;
    let writers = live.clone().filter(|pass| pass.accesses.iter().any(writes));
    writers
        .flat_map(|pass| &pass.accesses)
        .map(|access| &resources[access.resource.0])
        .filter(|resource| matches!(resource.kind, ResourceKind::Provided(_)))
        .map(|resource| resource.name.as_str())
        .collect()
}

/// Returns the layout of the items of a buffer that a live pass binds as an array of plain items or
/// as a single item; `None` if no live pass does.
pub(super) fn item_of<'p>(
    live: impl Iterator<Item = &'p LinkedPass> + Clone,
    target: &Target,
) -> Option<Item> {
    let origin = origin(live.clone(), target);
    let programs = live.flat_map(|pass| &pass.steps).filter_map(Step::program);
    let mut seen = programs.flat_map(|program| {
        let bindings = program.bindings.iter();
        bindings.map(move |binding| (&program.shader.module, binding))
    });
    let (module, binding) = seen.find(|(_, binding)| {
        matches!(&binding.target, BindTarget::Buffer(target)
            if target.id == origin && target.part.items().is_none())
    })?;
    let place = naga::ResourceBinding {
        group: binding.group,
        binding: binding.binding,
    };
    let mut globals = module.global_variables.iter();
    let (_, global) = globals.find(|(_, global)| global.binding == Some(place))?;
    item(module, global.ty)
}

/// Returns the mips and layers of a texture, or items of a buffer, that a target holds.
pub(super) fn part<'p>(
    live: impl Iterator<Item = &'p LinkedPass>,
    target: &Target,
    resources: &[Resource],
) -> PartSummary {
    // A capture holds the part that its step copies.
    let captures = live.filter(|pass| pass.is_capture());
    let copied = captures
        .flat_map(|pass| &pass.steps)
        .find_map(|step| match step {
            Step::Copy { from, to } if to.id == target.id => Some(from),
            _ => None,
        });
    let target = copied.unwrap_or(target);
    let kind = &resources[target.id.0].kind;
    let mips = match kind {
        ResourceKind::Texture(texture) => texture.mips,
        _ => 1,
    };
    let whole = [mips, kind.layers(0)];
    let layers = &target.part.layers;
    PartSummary {
        mips: target.part.mips.clone(),
        layers: layers.start..layers.end.min(whole[1]),
        of: whole,
    }
}

/// Returns the resource that a target is a copy of, or else the resource of the target.
fn origin<'p>(live: impl Iterator<Item = &'p LinkedPass>, target: &Target) -> ResourceId {
    let steps: Vec<&Step<Ids>> = live.flat_map(|pass| &pass.steps).collect();
    // The last copy onto it counts; its source was copied before.
    let steps = steps.into_iter().rev();
    steps.fold(target.id, |origin, step| match step {
        Step::Copy { from, to } if to.id == origin => from.id,
        _ => origin,
    })
}
