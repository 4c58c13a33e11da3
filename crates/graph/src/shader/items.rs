//! Item layouts of buffers, scalar by scalar, as the shaders that bind the buffers declare them.

use crate::scalar_class::ItemScalar;
use naga::{Handle, TypeInner};

/// One scalar in each item of a buffer, such as `origin.x`, as a shader declares the item.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Field {
    /// Path of the scalar in the item, as in WGSL: `origin.x`, `indices[2]`. Empty if the item is a
    /// single scalar.
    pub name: String,
    /// Offset in bytes of the scalar from the start of the item.
    pub offset: usize,
    /// Type of the scalar, which takes 4 bytes.
    pub scalar: ItemScalar,
}

/// Layout of one item of a buffer: an element of its array, or the whole buffer without an array,
/// as a shader that binds the buffer declares it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Item {
    /// Distance in bytes from the start of one item to the start of the next; for a buffer without
    /// an array its size.
    pub stride: usize,
    /// All scalars of the item, from 1 to 64, in the order of their offsets; bytes between them are
    /// padding.
    pub fields: Vec<Field>,
}

/// An item with more scalars than this is no row of a table.
const MOST_FIELDS: usize = 64;

pub(crate) fn item(module: &naga::Module, ty: Handle<naga::Type>) -> Option<Item> {
    let inner = &module.types[ty].inner;
    let (item_ty, stride) = match inner {
        TypeInner::Array { base, stride, .. } => (*base, *stride),
        _ => (ty, inner.size(module.to_ctx())),
    };
    let mut fields = Vec::new();
    flatten(module, item_ty, String::new(), 0, &mut fields)?;
    Some(Item {
        stride: stride as usize,
        fields,
    })
}

/// Adds the scalars of a type; `None` if it has one that is no 32-bit number, or too many.
fn flatten(
    module: &naga::Module,
    ty: Handle<naga::Type>,
    name: String,
    offset: usize,
    fields: &mut Vec<Field>,
) -> Option<()> {
    let mut push = |name: String, offset, scalar: naga::Scalar| {
        let scalar = ItemScalar::from_kind(scalar.kind).filter(|_| scalar.width == 4)?;
        fields.push(Field {
            name,
            offset,
            scalar,
        });
        (fields.len() <= MOST_FIELDS).then_some(())
    };
    let dot = if name.is_empty() { "" } else { "." };
    match &module.types[ty].inner {
        TypeInner::Scalar(scalar) | TypeInner::Atomic(scalar) => push(name, offset, *scalar),
        TypeInner::Vector { size, scalar } => ["x", "y", "z", "w"]
            .iter()
            .take(*size as usize)
            .enumerate()
            .try_for_each(|(index, axis)| {
                let place = offset + index * usize::from(scalar.width);
                push(format!("{name}{dot}{axis}"), place, *scalar)
            }),
        TypeInner::Array {
            base,
            size: naga::ArraySize::Constant(count),
            stride,
        } => (0..count.get() as usize).try_for_each(|index| {
            let place = offset + index * *stride as usize;
            flatten(module, *base, format!("{name}[{index}]"), place, fields)
        }),
        TypeInner::Struct { members, .. } => members.iter().try_for_each(|member| {
            let name = format!("{name}{dot}{}", member.name.as_deref().unwrap_or("_"));
            let place = offset + member.offset as usize;
            flatten(module, member.ty, name, place, fields)
        }),
        _ => None,
    }
}
