//! Reads accessors, never beyond the buffers that they name.

use super::buffers::Buffers;
use gltf::accessor::{Accessor, DataType};

/// An accessor's items as numbers, `N` each; normalised integers as fractions.
///
/// # Errors
/// The first mistake.
pub(super) fn floats<const N: usize>(
    accessor: &Accessor<'_>,
    buffers: &Buffers,
) -> Result<Vec<[f32; N]>, String> {
    unnamed_floats(accessor, buffers).map_err(|why| named(accessor, why))
}

/// Says which accessor it is.
pub(super) fn named(accessor: &Accessor<'_>, why: String) -> String {
    format!("accessor {}: {why}", accessor.index())
}

fn unnamed_floats<const N: usize>(
    accessor: &Accessor<'_>,
    buffers: &Buffers,
) -> Result<Vec<[f32; N]>, String> {
    let width = accessor.dimensions().multiplicity();
    if width < N {
        return Err(format!("its items have {width} numbers, expected {N}"));
    }
    let (ty, normalized) = (accessor.data_type(), accessor.normalized());
    let item = |bytes: &[u8]| -> [f32; N] {
        std::array::from_fn(|at| number(&bytes[at * ty.size()..], ty, normalized) as f32)
    };
    let mut items: Vec<[f32; N]> = match accessor.view() {
        Some(view) => {
            let places = [accessor.offset(), accessor.size(), accessor.count()];
            raw(&view, places, buffers)?.map(item).collect()
        }
        None => {
            // Zeros that no buffer holds: a damaged count must not take memory without bound.
            let limit = 1 << 26;
            if accessor.count() > limit {
                return Err(format!("{} items without a buffer", accessor.count()));
            }
            vec![[0.0; N]; accessor.count()]
        }
    };
    let Some(sparse) = accessor.sparse() else {
        return Ok(items);
    };
    let (indices, values) = (sparse.indices(), sparse.values());
    let index_type = match indices.index_type() {
        gltf::accessor::sparse::IndexType::U8 => DataType::U8,
        gltf::accessor::sparse::IndexType::U16 => DataType::U16,
        gltf::accessor::sparse::IndexType::U32 => DataType::U32,
    };
    let (view, count) = (indices.view(), sparse.count());
    let places = raw(&view, [indices.offset(), index_type.size(), count], buffers)?;
    let view = values.view();
    let values = raw(&view, [values.offset(), accessor.size(), count], buffers)?;
    let total = items.len();
    for (place, value) in places.zip(values) {
        let place = whole(place, index_type) as usize;
        let slot = items
            .get_mut(place)
            .ok_or_else(|| format!("its sparse values name item {place}, but it has {total}"))?;
        *slot = item(value);
    }
    Ok(items)
}

/// An accessor's items as indices.
///
/// # Errors
/// The first mistake.
pub(super) fn indices(accessor: &Accessor<'_>, buffers: &Buffers) -> Result<Vec<u32>, String> {
    let ty = accessor.data_type();
    if accessor.dimensions().multiplicity() != 1 || accessor.sparse().is_some() {
        return Err("indices are single whole numbers, none of them sparse".to_owned());
    }
    if !matches!(ty, DataType::U8 | DataType::U16 | DataType::U32) {
        return Err(format!("indices are unsigned whole numbers, not {ty:?}"));
    }
    let view = accessor.view().ok_or("indices without a buffer view")?;
    let places = [accessor.offset(), ty.size(), accessor.count()];
    let items = raw(&view, places, buffers)?;
    Ok(items.map(|bytes| whole(bytes, ty)).collect())
}

/// The bytes of `count` items of `size` bytes each, of which the first begins at `offset`.
fn raw<'b>(
    view: &gltf::buffer::View<'_>,
    [offset, size, count]: [usize; 3],
    buffers: &'b Buffers,
) -> Result<impl Iterator<Item = &'b [u8]> + use<'b>, String> {
    let bytes = buffers.view(view).ok_or_else(|| {
        format!(
            "buffer view {} reaches beyond buffer {}",
            view.index(),
            view.buffer().index()
        )
    })?;
    let read = buffers.strides.get(&view.index()).copied();
    let stride = view.stride().or(read).unwrap_or(size).max(1);
    let end = end_of(count, stride, size, offset);
    if count > 0 && end.is_none_or(|end| end > bytes.len()) {
        return Err(format!(
            "{count} items of {size} bytes reach beyond buffer view {}, which has {} bytes",
            view.index(),
            bytes.len()
        ));
    }
    let first = bytes.get(offset..).unwrap_or_default();
    Ok((0..count).map(move |item| &first[item * stride..item * stride + size]))
}

/// Where so many items end of which the first begins at an offset; `None` if that overflows.
pub(super) fn end_of(count: usize, stride: usize, size: usize, offset: usize) -> Option<usize> {
    let Some(last) = count.checked_sub(1) else {
        return Some(offset);
    };
    last.checked_mul(stride)?
        .checked_add(size)?
        .checked_add(offset)
}

fn whole(bytes: &[u8], ty: DataType) -> u32 {
    match ty {
        DataType::U8 | DataType::I8 => u32::from(bytes[0]),
        DataType::U16 | DataType::I16 => u32::from(u16::from_le_bytes([bytes[0], bytes[1]])),
        DataType::U32 | DataType::F32 => {
            u32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]])
        }
    }
}

/// The number that bytes begin with; a normalised integer as a fraction.
pub(super) fn number(bytes: &[u8], ty: DataType, normalized: bool) -> f64 {
    let word = whole(bytes, ty);
    let (value, most) = match ty {
        DataType::F32 => return f64::from(f32::from_bits(word)),
        DataType::I8 => (f64::from(word as u8 as i8), 127.0),
        DataType::I16 => (f64::from(word as u16 as i16), 32767.0),
        DataType::U8 => (f64::from(word), 255.0),
        DataType::U16 => (f64::from(word), 65535.0),
        // Not more exact than a single float.
        DataType::U32 => (f64::from(word as f32), 4_294_967_296.0),
    };
    if normalized {
        (value / most).max(-1.0)
    } else {
        value
    }
}
