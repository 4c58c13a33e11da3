//! Growth of materials between frames: first size, counter and greatest size.

use crate::diagnostics::Reported;
use crate::document::{BufferEntry, GrowEntry, TextureEntry};
use crate::errors::resource::SizeError;
use crate::expressions::{Environment, eval};
use crate::language::Reference;
use crate::resource::{Buffer, Growth, Origin, Resource, ResourceKind, Target, Texture};
use crate::source::Located;

/// Environment in which the size of a material is found.
pub(super) trait Sizing: Environment {
    /// Resolves a reference to another material that the size asks for.
    fn resource(&mut self, reference: &Reference) -> Reported<(Target, &Resource)>;
}

/// Sets the number of items of a buffer with `grow`: `grown` is the number that earlier frames
/// needed. Returns `None` for a buffer without `grow`.
pub(super) fn grow_buffer(
    entry: &BufferEntry,
    buffer: &mut Buffer,
    grown: u64,
    at: &mut impl Sizing,
) -> Reported<Option<Growth>> {
    let Some(grow) = &entry.grow else {
        return Ok(None);
    };
    let name = entry.name.text();
    let Some(count) = buffer.count.filter(|_| entry.count.is_some()) else {
        return Err(at.reports().report(SizeError::GrowWithoutCount(name)));
    };
    let growth = growth(&name.value, grow, at)?;
    buffer.count = Some(count.max(grown).min(growth.max));
    Ok(Some(growth))
}

/// Sets the number of layers of a texture with `grow`: `grown` is the number that earlier frames
/// needed, `most` that of the adapter. Returns `None` for a texture without `grow`.
pub(super) fn grow_texture(
    entry: &TextureEntry,
    texture: &mut Texture,
    (grown, most): (u64, u32),
    at: &mut impl Sizing,
) -> Reported<Option<Growth>> {
    let Some(grow) = &entry.grow else {
        return Ok(None);
    };
    let name = entry.name.text();
    if entry.layers.is_none() || texture.is_3d {
        return Err(at.reports().report(SizeError::GrowWithoutLayers(name)));
    }
    let growth = growth(&name.value, grow, at)?;
    let grown = grown.min(u64::from(most));
    let layers = u64::from(texture.layers).max(grown).min(growth.max);
    // Shaders and passes could take one layer for a texture without layers, and not go on when
    // there are more.
    if layers == 1 {
        return Err(at.reports().report(SizeError::GrowFromOne(name)));
    }
    texture.layers = u32::try_from(layers).unwrap_or(u32::MAX);
    Ok(Some(growth))
}

fn growth(name: &str, grow: &GrowEntry, at: &mut impl Sizing) -> Reported<Growth> {
    let (counter, resource) = at.resource(&grow.counter)?;
    let is_own = resource.origin == Origin::Own;
    if !(is_own && matches!(resource.kind, ResourceKind::Buffer(_))) {
        let what = if is_own {
            resource.kind.describe()
        } else {
            "not made by this graph"
        };
        let name = grow.counter.located();
        return Err(at.reports().report(SizeError::Counter(name, what)));
    }
    let max = match eval::count(&grow.max, at)? {
        0 if grow.max.is_taken() => 1,
        0 => {
            let name = Located::new(name.to_owned(), grow.max.span.clone());
            return Err(at.reports().report(SizeError::GrowToNothing(name)));
        }
        max => max,
    };
    Ok(Growth { counter, max })
}
