// In the place of shared/linked_lists.wgsl: texels list receivers, and a caster that would be
// listed in a texel is tested for each of them.

#import "shared/pending_answer.wgsl"

// The block of each texel that this thread tests.
var<private> block: u32 = 0u;

fn is_tile_wanted(tile: vec4<u32>) -> bool {
    return tile.w > block_size * block;
}

fn is_within_list(texel: u32) -> bool {
    return atomicLoad(&texels[texel].length) > block_size * block;
}

fn reserved_slots(count: u32) -> u32 {
    return 0u;
}

fn append_entry(texel: u32, slot: u32, caster: u32, key: vec2<u32>) {
    test_receivers(texel, caster, key, true);
}

// Tests a caster that has no key for those without a texel.
fn test_placeless(caster: u32) {
    let last = arrayLength(&texels) - 1u;
    if is_within_list(last) {
        test_receivers(last, caster, vec2(0u), false);
    }
}

fn test_receivers(texel: u32, caster: u32, key: vec2<u32>, has_key: bool) {
    let a = corner_position(3u * caster);
    let b = corner_position(3u * caster + 1u);
    let c = corner_position(3u * caster + 2u);
    let corners = Corners(a, b, c, caster_primitive(caster));
    let first = atomicLoad(&texels[texel].head);
    let count = atomicLoad(&texels[texel].length);
    let end = first + min(count, block_size * (block + 1u));
    let width = textureDimensions(position).x;
    let summed = light_clip_summands_of_scene();
    for (var place = first + block_size * block; place < end; place++) {
        let word = atomicLoad(&pending[receiver_words * place]);
        if (word & IS_SHADED) != 0u {
            continue;
        }
        let pixel = vec2(word % width, word / width);
        let receiver = textureLoad(position, pixel, 0).xyz;
        if has_key {
            let at = place_of(receiver, summed);
            let offset = vec2<i32>(round(at.offset * 4096.0));
            let coarse = coarse_depth(bitcast<f32>(at.depth));
            let is_clear = (inside_of(key, offset) | behind_of(key, coarse)) < 0;
            if at.texel == texel && is_clear {
                continue;
            }
        }
        if textureLoad(primitive, pixel, 0).x != corners.primitive {
            test_receiver(PendingReceiver(receiver, place, word, has_key), corners, caster);
        }
    }
}
