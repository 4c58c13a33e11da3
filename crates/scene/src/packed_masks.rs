//! The masks of a mesh as shaders read them.

use crate::{mask::Mask, material::Surfaces, mesh::Mesh};
use std::collections::HashMap;

/// Words of a triangle's record in [`mask_words`]: six texture coordinates and the mask's place.
const RECORD: usize = 7;

/// In the table of [`mask_words`]: the back face is seen, too.
pub const DOUBLE_SIDED: u32 = 0x8000_0000;

/// Masks as shaders read them (`shared/masks.wgsl`): a word per triangle, [`DOUBLE_SIDED`] and the
/// place of its record, 0 where it has no mask; behind them the records, then the masks: width,
/// height, how u and v are wrapped (two bits each), bits. Empty if no triangle is masked or
/// double-sided.
pub fn mask_words(mesh: &Mesh) -> Vec<u32> {
    let surfaces = &mesh.surfaces;
    if !surfaces.need_care() {
        return Vec::new();
    }
    let count = mesh.triangles.len() as u32;
    let mut words = vec![0; count as usize];
    let mut waiting: Vec<(usize, usize)> = Vec::new();
    for primitive in 0..count {
        let own = &mut words[primitive as usize];
        if surfaces.is_double_sided(primitive) {
            *own |= DOUBLE_SIDED;
        }
        if surfaces.mask(primitive).is_none() {
            continue;
        }
        let record = words.len();
        words[primitive as usize] |= record as u32;
        let uvs = surfaces.corner_uvs(primitive).map(|uv| uv.to_array());
        words.extend(uvs.as_flattened().iter().map(|value| value.to_bits()));
        words.push(0);
        let material = surfaces.of[primitive as usize] as usize;
        waiting.push((record + RECORD - 1, material));
    }
    append_masks(surfaces, &waiting, &mut words);
    words
}

/// Appends each mask once, and writes its place to the records that wait for it.
fn append_masks(surfaces: &Surfaces, waiting: &[(usize, usize)], words: &mut Vec<u32>) {
    let mut places: HashMap<*const Mask, u32> = HashMap::new();
    for &(at, material) in waiting {
        let Some(mask) = surfaces.materials[material].mask.as_deref() else {
            continue;
        };
        let place = *places.entry(std::ptr::from_ref(mask)).or_insert_with(|| {
            let place = words.len() as u32;
            let wraps = mask.wrap.map(|wrap| wrap as u32);
            words.extend([mask.size[0], mask.size[1], wraps[0] | wraps[1] << 2]);
            words.extend(&mask.opaque);
            place
        });
        words[at] = place;
    }
}
