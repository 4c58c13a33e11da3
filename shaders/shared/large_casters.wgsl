// Parts of triangles over many tiles, for workgroups of their own.

#import "shared/groups.wgsl"
#import "shared/bin_texels.wgsl"
#import "shared/clusters.wgsl"

struct Large {
    // Those included for which there is no room.
    count: atomic<u32>,
    parts: array<Part>,
}

var<storage, read_write> large: Large;
var<storage, read_write> live_clusters: LiveClusters;

// Returns the first slot of as many parts, and has workgroups run for them.
fn reserved_parts(count: u32) -> u32 {
    let slot = atomicAdd(&large.count, count);
    let end = min(slot + count, arrayLength(&large.parts));
    if slot + count > end {
        atomicStore(&texels[arrayLength(&texels) - 1u].length, LIST_LACKS);
    }
    let groups = (end + PARTS_PER_GROUP - 1u) / PARTS_PER_GROUP;
    atomicMax(&live_clusters.large_groups[0], min(groups, GROUPS_PER_ROW));
    atomicMax(&live_clusters.large_groups[1], (groups + GROUPS_PER_ROW - 1u) / GROUPS_PER_ROW);
    atomicMax(&live_clusters.large_groups[2], 1u);
    return slot;
}

fn store_part(slot: u32, part: Part) {
    if slot < arrayLength(&large.parts) {
        large.parts[slot] = part;
    }
}

// Parts that have room.
fn part_count() -> u32 {
    return min(atomicLoad(&large.count), arrayLength(&large.parts));
}
