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
// Sum over all turns.
var<storage, read_write> ray_count: u32;

@compute @workgroup_size(1)
fn main() {
    let samples = samples_needed(params.samples);
    let turn = min(max(samples, params.first) - params.first, params.at_once);
    let count = asked_count * turn;
    sample_count = count;
    ray_count += count;
    sample_groups = groups_for(count);
}
