// Binning for adapters that run few threads at a time: a thread takes the tiles of its caster in
// turns, and the texels of each. `shared/wide_binning.wgsl` stands in for this on others.

#import "shared/bin_texels.wgsl"
#import "shared/large_casters.wgsl"

// Tiles under the box of a caster that one thread does alone.
const ALONE: u32 = 32u;
// Tiles of a part, whose workgroup's threads take them in turns.
const PART: u32 = 2048u;
const PARTS_PER_GROUP: u32 = 1u;

fn bin_caster(number: u32, thread: u32) {
    if number >= caster_count() {
        return;
    }
    let caster = caster_of(number);
    if any(caster.last < caster.first) {
        return;
    }
    let tiles = tiles_of(caster);
    let count = tiles.x * tiles.y;
    if count <= ALONE {
        bin(caster, 0u, count, 1u);
        return;
    }
    let parts = (count + PART - 1u) / PART;
    let slot = reserved_parts(parts);
    for (var part = 0u; part < parts; part++) {
        count_step(PART_STEP);
        store_part(slot + part, Part(number, PART * part));
    }
}

fn bin_parts(group: u32, thread: u32) {
    if group >= part_count() {
        return;
    }
    let part = large.parts[group];
    let caster = caster_of(part.caster);
    let tiles = tiles_of(caster);
    let end = min(tiles.x * tiles.y, part.first_tile + PART);
    bin(caster, part.first_tile + thread, end, GROUP_SIZE);
}
