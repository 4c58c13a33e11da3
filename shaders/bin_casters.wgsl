// Stage to append each caster to the lists of the texels that it overlaps and in which some
// receiver is not nearer to the light. `bin_small`: one thread per triangle, which leaves those
// over many tiles to `bin_large`: one workgroup per part of a large one, whose threads take its
// tiles in turns. So no thread looks at more than 2,048 texels, however large a triangle is.

#import "shared/numbered_casters.wgsl"
#import "shared/groups.wgsl"
#import "shared/bin_texels.wgsl"
#import "shared/large_casters.wgsl"

// Tiles under the box of a triangle that one thread does alone.
const ALONE: u32 = 32u;
// Tiles of a part.
const PART: u32 = 2048u;

struct Thread {
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
}

@compute @workgroup_size(GROUP_SIZE)
fn bin_small(thread: Thread) {
    let number = (thread.group.y * thread.groups.x + thread.group.x) * GROUP_SIZE + thread.lane;
    if number >= caster_count() {
        return;
    }
    let caster = caster_of(number);
    if any(caster.last < caster.first) {
        return;
    }
    let tiles = tiles_of(caster);
    let count = tiles.x * tiles.y;
    if count > ALONE {
        for (var first = 0u; first < count; first += PART) {
            append_part(Part(number, first));
        }
        return;
    }
    bin(caster, 0u, count, 1u);
}

@compute @workgroup_size(GROUP_SIZE)
fn bin_large(thread: Thread) {
    let number = group_number(thread.group);
    if number >= min(atomicLoad(&large.count), arrayLength(&large.parts)) {
        return;
    }
    let part = large.parts[number];
    let caster = caster_of(part.caster);
    let tiles = tiles_of(caster);
    let end = min(tiles.x * tiles.y, part.first_tile + PART);
    bin(caster, part.first_tile + thread.lane, end, GROUP_SIZE);
}
