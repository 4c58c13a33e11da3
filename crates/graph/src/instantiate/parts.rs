//! Parts of resources: the mips, layers or items that references select, and attributes of parts.

use crate::diagnostics::Diagnostic;
use crate::errors::evaluation::EvaluationError;
use crate::errors::instantiate::InterfaceError;
use crate::language::{Attribute, Reference, Scalar, Value};
use crate::resource::{Resource, ResourceKind, Target};
use crate::source::{Located, Span};
use std::ops::Range;

/// Returns the word for a target's parts (`layers`, `slices` or `items`) and their number.
pub(super) fn layers(
    target: &Target,
    resource: &Resource,
    reference: &Reference,
) -> Result<(&'static str, u64), Diagnostic> {
    let what = match &resource.kind {
        ResourceKind::Texture(texture) => {
            let what = if texture.is_3d { "slices" } else { "layers" };
            return Ok((what, target.part.layers.len() as u64));
        }
        ResourceKind::Buffer(_) | ResourceKind::Provided(_) => "items",
        ResourceKind::Sampler(_)
        | ResourceKind::AccelerationStructure
        | ResourceKind::CpuWork
        | ResourceKind::Frame => {
            let what = "only textures and buffers have parts";
            return Err(InterfaceError::NoPart(reference.located(), what).into());
        }
    };
    let count = items(resource, target);
    Ok((what, count.ok_or_else(|| uncounted(resource, reference))?))
}

/// Returns the error for a buffer whose number of items is asked for but not known.
pub(super) fn uncounted(resource: &Resource, reference: &Reference) -> EvaluationError {
    let name = reference.located_path();
    match &resource.kind {
        ResourceKind::Provided(_) => EvaluationError::Uncounted(name),
        _ => EvaluationError::NoCount(name),
    }
}

/// Returns the word `mips` and the number of mips of a target.
pub(super) fn mips(
    target: &Target,
    resource: &Resource,
    reference: &Reference,
) -> Result<(&'static str, u64), InterfaceError> {
    match resource.kind {
        ResourceKind::Texture(_) => Ok(("mips", target.part.mips.len() as u64)),
        _ => {
            let what = "only textures have mips";
            Err(InterfaceError::NoPart(reference.located_path(), what))
        }
    }
}

/// Narrows a target to a range of its mips.
pub(super) fn select_mips(
    target: &mut Target,
    range: Range<u32>,
    resource: &Resource,
    reference: &Reference,
) -> Result<(), InterfaceError> {
    let start = target.part.mips.start;
    target.part.mips = start + range.start..start + range.end;
    if let ResourceKind::Texture(texture) = &resource.kind
        && texture.is_3d
    {
        let layers = texture.mip_layers(target.part.mips.start);
        if target.part.layers.start >= layers {
            let what = "this mip has fewer slices";
            return Err(InterfaceError::NoPart(reference.located(), what));
        }
        target.part.layers.end = target.part.layers.end.min(layers);
    }
    Ok(())
}

/// Checks that a range lies within `count` layers, items or mips; `what` is the word for them.
pub(super) fn narrow(
    (range, span): (Range<u64>, &Span),
    (what, count): (&str, u64),
    reference: &Reference,
    resource: &Resource,
) -> Result<Range<u32>, InterfaceError> {
    let fits = range.start < range.end && range.end <= count;
    let narrow = || Some(u32::try_from(range.start).ok()?..u32::try_from(range.end).ok()?);
    narrow().filter(|_| fits).ok_or_else(|| {
        let (start, last) = (range.start, count.saturating_sub(1));
        let what = match count {
            1 => format!("its {what} are [0] alone, this is [{start}]"),
            _ => format!("its {what} are [0] to [{last}], this is [{start}]"),
        };
        let part = Located::new(reference.text().to_owned(), span.clone());
        InterfaceError::Range(part, what, resource.declared.clone())
    })
}

/// Returns the value of an attribute of a target; `None` if the resource does not have this
/// attribute.
pub(super) fn attribute(
    resource: &Resource,
    target: &Target,
    attribute: Attribute,
) -> Option<Value> {
    let part = &target.part;
    let texture = match &resource.kind {
        ResourceKind::Texture(texture) => texture,
        ResourceKind::Buffer(_) | ResourceKind::Provided(_) if attribute == Attribute::Count => {
            return items(resource, target).map(Value::count);
        }
        ResourceKind::Provided(provided) if attribute == Attribute::Kind => {
            return provided.kind.map(Value::kind);
        }
        _ => return None,
    };
    let [width, height] = texture.mip_size(part.mips.start);
    let layers = if texture.is_3d {
        let slices = texture.mip_layers(part.mips.start) as usize;
        part.layers.len().min(slices)
    } else {
        part.layers.len()
    };
    let whole = |number: u32| Scalar::Whole(number.into());
    Some(match attribute {
        Attribute::Size if texture.is_3d => Value::List(vec![
            whole(width),
            whole(height),
            Scalar::Whole(layers as i64),
        ]),
        Attribute::Size => Value::List(vec![whole(width), whole(height)]),
        Attribute::Width => Value::whole(width),
        Attribute::Height => Value::whole(height),
        Attribute::Layers => Value::count(layers as u64),
        Attribute::Mips => Value::count(part.mips.len() as u64),
        Attribute::Samples => Value::whole(texture.samples),
        Attribute::Count => {
            let depth = if texture.is_3d { layers as u64 } else { 1 };
            let count = u64::from(width).saturating_mul(height.into());
            Value::count(count.saturating_mul(depth))
        }
        Attribute::Format => Value::Format(texture.format),
        Attribute::Kind | Attribute::Index => return None,
    })
}

/// Returns the number of items of a buffer that a target selects; `None` if the number is not
/// known.
pub(super) fn items(resource: &Resource, target: &Target) -> Option<u64> {
    let selected = target.part.items().map(|items| items.len() as u64);
    selected.or(match &resource.kind {
        ResourceKind::Buffer(buffer) => buffer.count,
        ResourceKind::Provided(provided) => provided.items,
        _ => None,
    })
}
