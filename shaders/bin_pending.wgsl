// Stage to test casters for the pending receivers in the texels that they overlap. `bin_small`: one
// thread per caster of the clusters that are live, for the first block of each texel's receivers;
// it leaves casters over many tiles to `bin_large`, a workgroup for each part of one and block, and
// further blocks to `bin_crowded`, a thread for each caster and block.

#import "shared/numbered_casters.wgsl"
#import "shared/pending_lists.wgsl" instead "shared/linked_lists.wgsl"
#import "shared/groups.wgsl"
#import "shared/bin_texels.wgsl"

var<storage, read_write> pending_casters: PendingCasters;
var<uniform> pending_box: PendingLayer;

@compute @workgroup_size(GROUP_SIZE)
fn bin_small(thread: Thread) {
    let group = group_number(thread.group);
    if group >= atomicLoad(&pending_casters.clusters) {
        return;
    }
    let number = pending_casters.words[group] * GROUP_SIZE + thread.lane;
    if number >= caster_count() {
        return;
    }
    let last = arrayLength(&texels) - 1u;
    var most = 0u;
    if binned_layer == 0u {
        most = atomicLoad(&texels[last].length);
        test_placeless(number);
    }
    let caster = pending_caster(number);
    if all(caster.last >= caster.first) {
        let tiles = tiles_of(caster);
        let count = tiles.x * tiles.y;
        if count > alone {
            append_parts(number, count);
        } else {
            for (var tile = 0u; tile < count; tile++) {
                let at = caster.first / TILE + vec2(tile % tiles.x, tile / tiles.x);
                most = max(most, tiles_most(at));
            }
            bin(caster, 0u, count, 1u);
        }
    }
    if most > block_size {
        let slot = atomicAdd(&pending_casters.left[LEFT_CROWDED], 1u);
        pending_casters.words[arrayLength(&pending_casters.words) - 1u - slot] = number;
    }
}

@compute @workgroup_size(GROUP_SIZE)
fn bin_large(thread: Thread) {
    let number = group_number(thread.group);
    if number >= min(pending_box.parts, part_limit()) {
        return;
    }
    block = thread.group.z;
    let word = part_word(number);
    let first_tile = pending_casters.words[word + 1u];
    let caster = pending_caster(pending_casters.words[word]);
    let tiles = tiles_of(caster);
    let end = min(tiles.x * tiles.y, first_tile + part_tiles());
    bin(caster, first_tile + thread.lane, end, GROUP_SIZE);
}

@compute @workgroup_size(GROUP_SIZE)
fn bin_crowded(thread: Thread) {
    let slot = thread_number(thread.group, thread.lane);
    if slot >= pending_box.crowded {
        return;
    }
    block = thread.group.z + 1u;
    let number = pending_casters.words[arrayLength(&pending_casters.words) - 1u - slot];
    if binned_layer == 0u {
        test_placeless(number);
    }
    let caster = pending_caster(number);
    let tiles = tiles_of(caster);
    if all(caster.last >= caster.first) && tiles.x * tiles.y <= alone {
        bin(caster, 0u, tiles.x * tiles.y, 1u);
    }
}

// A caster, its box cut to the tiles that hold receivers.
fn pending_caster(number: u32) -> Binned {
    var caster = caster_of(number);
    let is_none = pending_box.inverted_first.x == 0u;
    let first = TILE * ~pending_box.inverted_first;
    caster.first = select(max(caster.first, first), vec2(1u), is_none);
    let end = TILE * pending_box.last + TILE - 1u;
    caster.last = select(min(caster.last, end), vec2(0u), is_none);
    return caster;
}

// The most receivers of a texel in a tile.
fn tiles_most(tile: vec2<u32>) -> u32 {
    return tiles[tile_number(binned_layer, tile)].w;
}

// Tiles of a part: as many a thread as it does alone.
fn part_tiles() -> u32 {
    return GROUP_SIZE * alone;
}

fn part_word(number: u32) -> u32 {
    return clusters_of(caster_count()) + 2u * number;
}

// Behind them there is room for all casters.
fn part_limit() -> u32 {
    return (arrayLength(&pending_casters.words) - caster_count() - part_word(0u)) / 2u;
}

fn append_parts(number: u32, tiles: u32) {
    let parts = (tiles + part_tiles() - 1u) / part_tiles();
    var slot = atomicAdd(&pending_casters.left[LEFT_PARTS], parts);
    for (var part = 0u; part < parts && slot < part_limit(); part++) {
        pending_casters.words[part_word(slot)] = number;
        pending_casters.words[part_word(slot) + 1u] = part_tiles() * part;
        slot += 1u;
    }
}
