// Stage to turn the number of rays on the GPU into the arguments of an indirect dispatch of
// `trace_rays`; a single thread.

#import "shared/groups.wgsl"

var<storage, read> count: u32;
var<storage, read_write> groups: array<u32, 3>;

@compute @workgroup_size(1)
fn main() {
    // Not (count + 63) / 64: that overflows at the top of u32.
    let needed = count / GROUP_SIZE + select(0u, 1u, count % GROUP_SIZE != 0u);
    groups[0] = min(needed, GROUPS_PER_ROW);
    groups[1] = needed / GROUPS_PER_ROW + select(0u, 1u, needed % GROUPS_PER_ROW != 0u);
    groups[2] = 1u;
}
