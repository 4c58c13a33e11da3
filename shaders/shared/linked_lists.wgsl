// Lists of texels, each entry before those that were appended sooner.

struct Params {
    longest_list: u32,
}

var<uniform> params: Params;
// Those included for which there is no room.
var<storage, read_write> entry_count: atomic<u32>;

fn is_tile_wanted(tile: vec4<u32>) -> bool {
    return true;
}

// Counts an entry of a texel's list. A longer list is never read.
fn is_within_list(texel: u32) -> bool {
    return (atomicAdd(&texels[texel].length, 1u) & ~LIST_LACKS) < params.longest_list;
}

// The first of as many slots for entries as `append_entry` is called with, one after the other.
fn reserved_slots(count: u32) -> u32 {
    return atomicAdd(&entry_count, count);
}

fn append_entry(texel: u32, slot: u32, caster: u32, key: vec2<u32>) {
    if slot >= arrayLength(&entries) {
        atomicOr(&texels[texel].length, LIST_LACKS);
        return;
    }
    let next = atomicExchange(&texels[texel].head, slot + 1u);
    entries[slot] = vec4(next, caster_primitive(caster), key);
}
