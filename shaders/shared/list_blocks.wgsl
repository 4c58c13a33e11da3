// As shared/linked_lists.wgsl, but entries of a list lie beside each other, as they were appended,
// in blocks that are each twice as large as the one before it, up to a size: a walk over a long
// list does not wait for memory. The last entry names a next one, too, which may hold anything: a
// list is as long as its texel says.

struct Params {
    longest_list: u32,
}

var<uniform> params: Params;

struct Counted {
    // Entries of all blocks, those included for which there is no room.
    entries: atomic<u32>,
    // BLOCKS for each texel: the number of the first entry, 0 where there is no block.
    blocks: array<atomic<u32>>,
}

var<storage, read_write> entry_count: Counted;

// Blocks of a list: 3,056 entries.
const BLOCKS: u32 = 10u;
// Entries of the first, and of the largest.
const FIRST_BLOCK: u32 = 16u;
const LARGEST_BLOCK: u32 = 512u;
// The first of the largest, and entries before it.
const LARGEST: u32 = 5u;
const BEFORE_LARGEST: u32 = 496u;
// Blocks that begin farther on than any buffer ends are not counted, lest the sum overflows.
const MOST_ENTRIES: u32 = 0x40000000u;

fn is_tile_wanted(tile: vec4<u32>) -> bool {
    return true;
}

fn is_within_list(texel: u32) -> bool {
    return true;
}

fn reserved_slots(count: u32) -> u32 {
    return 0u;
}

fn append_entry(texel: u32, slot: u32, caster: u32, key: vec2<u32>) {
    let index = atomicAdd(&texels[texel].length, 1u) & ~LIST_LACKS;
    if index >= params.longest_list {
        return;
    }
    var block = firstLeadingBit(index / FIRST_BLOCK + 1u);
    var place = index - FIRST_BLOCK * ((1u << block) - 1u);
    if index >= BEFORE_LARGEST {
        block = LARGEST + (index - BEFORE_LARGEST) / LARGEST_BLOCK;
        place = (index - BEFORE_LARGEST) % LARGEST_BLOCK;
    }
    let number = first_of_block(texel, block) + place;
    var next = number + 1u;
    if place + 1u == block_size(block) {
        next = first_of_block(texel, block + 1u);
    }
    if index == 0u {
        atomicStore(&texels[texel].head, number);
    }
    if number > arrayLength(&entries) {
        atomicOr(&texels[texel].length, LIST_LACKS);
        return;
    }
    entries[number - 1u] = vec4(next, caster_primitive(caster), key);
}

// The number of a block's first entry. Threads that miss the block at the same time take room each,
// and all but one lose it.
fn first_of_block(texel: u32, block: u32) -> u32 {
    let place = BLOCKS * texel + block;
    var first = atomicLoad(&entry_count.blocks[place]);
    if first == 0u {
        let own = new_block(block_size(block));
        while first == 0u {
            let tried = atomicCompareExchangeWeak(&entry_count.blocks[place], 0u, own);
            first = select(tried.old_value, own, tried.exchanged);
        }
    }
    return first;
}

fn block_size(block: u32) -> u32 {
    return FIRST_BLOCK << min(block, LARGEST);
}

fn new_block(size: u32) -> u32 {
    if atomicLoad(&entry_count.entries) > MOST_ENTRIES {
        return MOST_ENTRIES;
    }
    return atomicAdd(&entry_count.entries, size) + 1u;
}
