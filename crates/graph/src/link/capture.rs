//! Captures: copies of materials as they stand after a pass.

use super::covered::{fully_overwrites, within};
use super::pass::{CAPTURE, LinkedPass};
use super::scope::PassScope;
use super::steps;
use crate::diagnostics::Reported;
use crate::errors::plan::OutputError;
use crate::instantiate::Run;
use crate::kinds::{Operand, Scratch, Step};
use crate::provider::Provided;
use crate::request::Capture;
use crate::resource::{Buffer, Origin, Resource, ResourceKind, SubresourceRange, Target};
use crate::source::Located;
use std::ops::Range;

/// Creates the pass that copies a material as it stands after the last of `passes`: the part of it
/// that has been written by then.
pub(super) fn link(
    capture: &Capture,
    passes: &[LinkedPass],
    scope: &mut PassScope<'_>,
) -> Reported<LinkedPass> {
    let Some(target) = scope.symbols.find_full(&capture.material) else {
        let symbols = &scope.symbols;
        let materials = symbols.reports.known(symbols.full_names());
        return Err(scope.report(OutputError::NoMaterial {
            graph: symbols.graph.path().to_owned(),
            name: capture.material.clone(),
            materials,
        }));
    };
    let mut target = target?;
    if let Some(part) = written_part(scope.get(target.id), &target, passes) {
        target.part = part;
    }
    let kind = scope.check(copy_of(capture, &target, scope))?;
    let name = Located::new(capture.name(), scope.symbols.graph.place());
    let copy = scope.add(name.value.clone(), kind);
    scope.enter_capture(target, copy);
    let steps = [Step::Copy {
        from: Operand::Scratch(Scratch(0)),
        to: Operand::Scratch(Scratch(1)),
    }];
    let mut pass = steps::link(name, CAPTURE, &steps, scope)?;
    // A capture runs even if the pass that it comes after does not: the change may have been
    // written above that one.
    pass.run = Run::OnChange;
    Ok(pass)
}

/// Returns a texture or buffer into which a part of a resource can be copied.
fn copy_of(
    capture: &Capture,
    target: &Target,
    scope: &PassScope<'_>,
) -> Result<ResourceKind, OutputError> {
    let name = capture.material.clone();
    Ok(match &scope.get(target.id).kind {
        ResourceKind::Texture(texture) => {
            let mut copy = texture.clone();
            copy.size = texture.mip_size(target.part.mips.start);
            copy.mips = target.part.mips.len() as u32;
            copy.layers = target.part.layers.len() as u32;
            copy.picture = None;
            ResourceKind::Texture(copy)
        }
        ResourceKind::Provided(Provided { items: None, .. }) => {
            return Err(OutputError::Unsized(name));
        }
        // It becomes as large as what is copied into it.
        ResourceKind::Buffer(_) | ResourceKind::Provided(_) | ResourceKind::Frame => {
            ResourceKind::Buffer(Buffer::default())
        }
        ResourceKind::Sampler(_) => {
            return Err(OutputError::Sampler(name));
        }
        ResourceKind::AccelerationStructure | ResourceKind::CpuWork => {
            let what = scope.get(target.id).kind.describe().to_owned();
            return Err(OutputError::Unreadable { name, what });
        }
    })
}

/// Returns the part of a target that passes have written: everything from the first to the last
/// mip, layer or item that was written. If something between these was not written, returns only
/// the part that the last pass has written. `None` if nothing was written, or if the resource has
/// content before the first pass.
fn written_part(
    resource: &Resource,
    target: &Target,
    passes: &[LinkedPass],
) -> Option<SubresourceRange> {
    // Resources from others, and kept ones, have content before the first pass.
    if resource.origin != Origin::Own || resource.keep {
        return None;
    }
    let written = |passes: &[LinkedPass]| -> Vec<SubresourceRange> {
        let accesses = passes.iter().flat_map(|pass| &pass.accesses);
        let written = accesses.filter(|it| it.writes && it.resource == target.id);
        let parts = written.filter_map(|it| within(&it.part, &target.part));
        parts.collect()
    };
    // The captures after a pass stand behind it.
    let last = passes.iter().rposition(|pass| !pass.is_capture())?;
    let own = written(&passes[last..=last]);
    let first = own.iter().take(1).cloned().collect();
    let both =
        |one: &Range<u32>, other: &Range<u32>| one.start.min(other.start)..one.end.max(other.end);
    [written(passes), own, first].into_iter().find_map(|parts| {
        let from_first_to_last = parts
            .iter()
            .cloned()
            .reduce(|one, other| SubresourceRange {
                mips: both(&one.mips, &other.mips),
                layers: both(&one.layers, &other.layers),
                ..one
            })?;
        fully_overwrites(&parts, &from_first_to_last, resource).then_some(from_first_to_last)
    })
}
