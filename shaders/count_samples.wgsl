// Stage to count the rays of one turn of samples, as a number and as workgroups; a single thread.

#import "shared/groups.wgsl"
#import "shared/light_area.wgsl"

struct Params {
    // Number of the turn's first sample.
    first: u32,
    at_once: u32,
    samples: u32,
}

var<uniform> params: Params;
var<storage, read> asked_count: u32;
var<storage, read_write> sample_count: u32;
var<storage, read_write> sample_groups: array<u32, 3>;
// Of all turns.
var<storage, read_write> ray_count: u32;

@compute @workgroup_size(1)
fn main() {
    let samples = samples_needed(params.samples);
    let turn = min(max(samples, params.first) - params.first, params.at_once);
    let count = asked_count * turn;
    sample_count = count;
    ray_count += count;
    let needed = count / GROUP_SIZE + select(0u, 1u, count % GROUP_SIZE != 0u);
    sample_groups[0] = min(needed, GROUPS_PER_ROW);
    sample_groups[1] = needed / GROUPS_PER_ROW + select(0u, 1u, needed % GROUPS_PER_ROW != 0u);
    sample_groups[2] = 1u;
}
