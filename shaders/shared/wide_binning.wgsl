// In the place of shared/binning.wgsl, for adapters that run many threads at a time: a thread alone
// takes a caster over few texels, and two texels of a tile otherwise. A workgroup reserves what its
// threads need by one atomic.

#import "shared/bin_texels.wgsl"
#import "shared/large_casters.wgsl"

// Texels and tiles under the box of a caster that one thread does alone.
const ALONE: u32 = 20u;
const ALONE_TILES: u32 = 4u;
// Tiles of a part, which half of a workgroup's threads take.
const PART: u32 = 8u;
const PARTS_PER_GROUP: u32 = 2u;
const LANES: u32 = 32u;
// Parts of a caster that its thread stores alone.
const FEW_PARTS: u32 = 8u;

// Parts and entries of the workgroup's threads, and the first slots of them.
var<workgroup> part_total: atomic<u32>;
var<workgroup> entry_total: atomic<u32>;
var<workgroup> first_part: u32;
var<workgroup> first_entry: u32;
// Casters of many parts: their number, parts and slot among the workgroup's.
var<workgroup> long_count: atomic<u32>;
var<workgroup> long: array<vec3<u32>, GROUP_SIZE>;

fn bin_caster(number: u32, thread: u32) {
    var caster: Binned;
    var listed = TileBits(vec4(0u), vec4(0u));
    var parts = 0u;
    if number < caster_count() {
        caster = caster_of(number);
        if all(caster.last >= caster.first) {
            let tiles = tiles_of(caster);
            let size = caster.last - caster.first + 1u;
            if size.x * size.y <= ALONE && tiles.x * tiles.y <= ALONE_TILES {
                listed = listing_texels(caster, tiles);
            } else {
                parts = (tiles.x * tiles.y + PART - 1u) / PART;
            }
        }
    }
    var part_slot = 0u;
    if parts != 0u {
        count_step(GROUP_STEP);
        part_slot = atomicAdd(&part_total, parts);
    }
    if parts > FEW_PARTS {
        count_step(GROUP_STEP);
        long[atomicAdd(&long_count, 1u)] = vec3(number, parts, part_slot);
    }
    let ones = countOneBits(listed.low) + countOneBits(listed.high);
    var slot = reserved_in_group(ones.x + ones.y + ones.z + ones.w);
    count_step(GROUP_STEP);
    workgroupBarrier();
    if thread == 0u {
        count_step(GROUP_STEP);
        reserve_parts();
    }
    reserve_for_group(thread);
    if parts <= FEW_PARTS {
        for (var part = 0u; part < parts; part++) {
            count_step(PART_STEP);
            store_part(first_part + part_slot + part, Part(number, PART * part));
        }
    }
    let count = atomicLoad(&long_count);
    for (var item = thread / LANES; item < count; item += GROUP_SIZE / LANES) {
        let one = long[item];
        for (var part = thread % LANES; part < one.y; part += LANES) {
            count_step(PART_STEP);
            store_part(first_part + one.z + part, Part(one.x, PART * part));
        }
    }
    if has_bits(listed) {
        let lines = lines_of(caster);
        while has_bits(listed) {
            count_step(ENTRY_STEP);
            append(caster, take_texel(caster, &listed), first_entry + slot, lines);
            slot += 1u;
        }
    }
}

fn reserve_parts() {
    let total = atomicLoad(&part_total);
    if total != 0u {
        first_part = reserved_parts(total);
    }
}

// The thread's first slot among the entries of its workgroup.
fn reserved_in_group(entries_here: u32) -> u32 {
    if entries_here == 0u {
        return 0u;
    }
    count_step(GROUP_STEP);
    return atomicAdd(&entry_total, entries_here);
}

// Sets `first_entry`, behind a barrier.
fn reserve_for_group(thread: u32) {
    if thread == 0u {
        count_step(GROUP_STEP);
        first_entry = reserved_slots(atomicLoad(&entry_total));
    }
    count_step(GROUP_STEP);
    workgroupBarrier();
}

// Bits of the texels in up to four tiles, as `texels_in` has those of one.
struct TileBits {
    low: vec4<u32>,
    high: vec4<u32>,
}

fn has_bits(bits: TileBits) -> bool {
    return any((bits.low | bits.high) != vec4(0u));
}

fn is_tile(tile: u32) -> vec4<bool> {
    return vec4(0u, 1u, 2u, 3u) == vec4(tile);
}

// Takes the first texel away, and returns it.
fn take_texel(caster: Binned, bits: ptr<function, TileBits>) -> vec2<u32> {
    let has_any = ((*bits).low | (*bits).high) != vec4(0u);
    let tile = select(select(select(3u, 2u, has_any.z), 1u, has_any.y), 0u, has_any.x);
    let low = select(vec4(0u), (*bits).low, is_tile(tile));
    let high = select(vec4(0u), (*bits).high, is_tile(tile));
    let inside = vec2(low.x | low.y | low.z | low.w, high.x | high.y | high.z | high.w);
    let bit = first_bit(inside);
    (*bits).low &= ~select(vec4(0u), vec4(bit.x), is_tile(tile));
    (*bits).high &= ~select(vec4(0u), vec4(bit.y), is_tile(tile));
    let columns = tiles_of(caster).x;
    let place = caster.first / TILE + vec2(tile % columns, tile / columns);
    return place * TILE + first_of(inside);
}

// The texels that list a caster over few.
fn listing_texels(caster: Binned, tiles: vec2<u32>) -> TileBits {
    var inside = TileBits(vec4(0u), vec4(0u));
    for (var tile = 0u; tile < tiles.x * tiles.y; tile++) {
        count_step(TILE_STEP);
        let place = caster.first / TILE + vec2(tile % tiles.x, tile / tiles.x);
        let bits = texels_in(caster, place);
        inside.low = select(inside.low, vec4(bits.x), is_tile(tile));
        inside.high = select(inside.high, vec4(bits.y), is_tile(tile));
    }
    var listed = inside;
    while has_bits(inside) {
        count_step(TEXEL_STEP);
        let before = inside;
        if !is_listed(caster, take_texel(caster, &inside)) {
            listed.low &= ~(before.low ^ inside.low);
            listed.high &= ~(before.high ^ inside.high);
        }
    }
    return listed;
}

// Tiles of each part that have texels to look at, and these.
var<workgroup> tile_counts: array<atomic<u32>, PARTS_PER_GROUP>;
var<workgroup> part_tiles: array<array<vec4<u32>, PART>, PARTS_PER_GROUP>;

fn bin_parts(group: u32, thread: u32) {
    let own = thread / LANES;
    let lane = thread % LANES;
    let number = PARTS_PER_GROUP * group + own;
    let parts = part_count();
    // Parts behind the last one have no tile.
    let part = large.parts[min(number, max(parts, 1u) - 1u)];
    let caster = caster_of(part.caster);
    let tiles = tiles_of(caster);
    let tile_number_here = part.first_tile + lane;
    if number < parts && lane < PART && tile_number_here < tiles.x * tiles.y {
        let place = vec2(tile_number_here % tiles.x, tile_number_here / tiles.x);
        let tile = caster.first / TILE + place;
        let inside = texels_in(caster, tile);
        count_step(TILE_STEP);
        if any(inside != vec2(0u)) {
            count_step(GROUP_STEP);
            part_tiles[own][atomicAdd(&tile_counts[own], 1u)] = vec4(tile, inside);
        }
    }
    count_step(GROUP_STEP);
    workgroupBarrier();
    // Two bits for each tile: whether the thread's texels of its upper and lower half list the
    // caster.
    var listed = 0u;
    for (var item = 0u; item < 2u * atomicLoad(&tile_counts[own]); item++) {
        let tile = part_tiles[own][item / 2u];
        let word = select(tile.w, tile.z, item % 2u == 0u);
        if ((word >> lane) & 1u) != 0u {
            count_step(TEXEL_STEP);
            let is_one = is_listed(caster, texel_in(tile.xy, item, lane));
            listed |= select(0u, 1u << item, is_one);
        }
    }
    var slot = reserved_in_group(countOneBits(listed));
    count_step(GROUP_STEP);
    workgroupBarrier();
    reserve_for_group(thread);
    let lines = lines_of(caster);
    while listed != 0u {
        count_step(ENTRY_STEP);
        let item = countTrailingZeros(listed);
        let tile = part_tiles[own][item / 2u].xy;
        append(caster, texel_in(tile, item, lane), first_entry + slot, lines);
        listed &= listed - 1u;
        slot += 1u;
    }
}

fn texel_in(tile: vec2<u32>, item: u32, lane: u32) -> vec2<u32> {
    return tile * TILE + vec2(lane % TILE, lane / TILE + (item % 2u) * (TILE / 2u));
}
