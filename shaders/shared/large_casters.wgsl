// Parts of triangles over many tiles, for workgroups of their own.

#import "shared/groups.wgsl"
#import "shared/bin_texels.wgsl"

struct Large {
    // Those included for which there is no room.
    count: atomic<u32>,
    parts: array<Part>,
}

var<storage, read_write> large: Large;
// Workgroups in x, y, z: one for each part.
var<storage, read_write> large_groups: array<atomic<u32>, 3>;

fn append_part(part: Part) {
    let slot = atomicAdd(&large.count, 1u);
    if slot >= arrayLength(&large.parts) {
        atomicStore(&texels[arrayLength(&texels) - 1u].length, LIST_LACKS);
        return;
    }
    large.parts[slot] = part;
    atomicMax(&large_groups[0], min(slot + 1u, GROUPS_PER_ROW));
    atomicMax(&large_groups[1], slot / GROUPS_PER_ROW + 1u);
    atomicMax(&large_groups[2], 1u);
}
