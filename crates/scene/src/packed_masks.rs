//! Packs the masks of a mesh into one buffer for shaders, and the roles of its triangles in shadows
//! into another.

use crate::{mask::Mask, material::Surfaces, mesh::Mesh};
use std::collections::HashMap;

/// Words of a triangle's record in [`mask_words`]: six texture coordinates and the mask's place.
const RECORD: usize = 7;

/// Flag in a triangle's word of [`mask_words`]: the triangle's back face is visible as well as its
/// front face.
pub const DOUBLE_SIDED: u32 = 0x8000_0000;

/// Packs the masks of a mesh's triangles into one list of words, the layout of `shared/masks.wgsl`.
/// The list begins with one word per triangle: the flag [`DOUBLE_SIDED`], and the index of the
/// triangle's record in the list, or 0 for a triangle without a mask. Records of seven words
/// follow: three pairs of texture coordinates as f32 bits, and the index of the mask in the list.
/// Masks come last: width and height in texels, a word with the wrapping of u (bits 0 and 1) and v
/// (bits 2 and 3; 0 repeats, 1 mirrors, 2 clamps), and one bit per texel as in [`Mask::opaque`].
/// The list is empty if no triangle is masked or double-sided.
pub fn mask_words(mesh: &Mesh) -> Vec<u32> {
    let surfaces = &mesh.surfaces;
    if !surfaces.need_care() {
        return Vec::new();
    }
    let count = mesh.triangles.len() as u32;
    let mut words = vec![0; count as usize];
    let mut waiting: Vec<(usize, usize)> = Vec::new();
    for primitive in 0..count {
        words[primitive as usize] = DOUBLE_SIDED * u32::from(surfaces.is_double_sided(primitive));
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

/// Packs the [roles](crate::Shadows) of a mesh's triangles for shaders: two bits for each, 16
/// triangles to a word, lowest bits first. The lower bit is set for a triangle that casts no
/// shadow, the upper for one that receives none. Returns no words if all triangles do both.
pub fn shadow_words(mesh: &Mesh) -> Vec<u32> {
    let surfaces = &mesh.surfaces;
    if !surfaces.have_roles() {
        return Vec::new();
    }
    let bits = |primitive: u32| {
        let receives = surfaces.shadows(primitive).receives();
        u32::from(!mesh.casts(primitive)) | u32::from(!receives) << 1
    };
    let count = mesh.triangles.len() as u32;
    let word = |first: u32| {
        let own = first..count.min(first + 16);
        own.fold(0, |word, at| word | bits(at) << (2 * (at % 16)))
    };
    (0..count).step_by(16).map(word).collect()
}
