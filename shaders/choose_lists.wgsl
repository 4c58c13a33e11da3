// Stage to choose lists or rays for all receivers, by an estimate of how long either takes; a
// single thread. Their answers are the same. Figures: docs/light_buffer_area.md.

#import "shared/groups.wgsl"
#import "shared/all_cast.wgsl"
#import "shared/light_area.wgsl"
#import "shared/light_buffer.wgsl"

struct Params {
    samples: u32,
}

var<uniform> params: Params;
// Entries of one caster in 31, texels with a receiver, and receivers.
var<storage, read> estimate: array<u32, 3>;
var<storage, read_write> texels: array<Texel>;
// The workgroups of box_casters.wgsl: none where rays are chosen.
var<storage, read_write> box_groups: array<u32, 3>;
// Draws of a full-screen triangle, or of none: vertices, instances, the first of each.
var<storage, read_write> test_call: array<u32, 4>;
var<storage, read_write> leave_call: array<u32, 4>;
// Counts the rays of later passes.
var<storage, read_write> ray_count: u32;

// As long as a ray takes: to make an entry, to walk over one, and to test 64 samples of one, fewer
// where there are fewer.
const MAKING: f32 = 0.035;
const WALKING: f32 = 0.013;
const TESTING: f32 = 0.012;

@compute @workgroup_size(1)
fn main() {
    ray_count = 0u;
    let entries = 31.0 * f32(estimate[0]);
    let length = entries / max(f32(estimate[1]), 1.0);
    let turns = (params.samples + 63u) / 64u;
    let tested = f32(turns) * WALKING + f32(params.samples) / 64.0 * TESTING;
    let lists = MAKING * entries / max(f32(estimate[2]), 1.0) + length * tested;
    // A light without extent takes one ray.
    if lists > f32(params.samples) && light_area.radius > 0.0 {
        // So no cluster is binned.
        texels[arrayLength(&texels) - 1u].length = LIST_LACKS;
        box_groups = array(0u, 0u, 0u);
        test_call = array(0u, 0u, 0u, 0u);
        leave_call = array(3u, 1u, 0u, 0u);
        return;
    }
    test_call = array(3u, 1u, 0u, 0u);
    leave_call = array(0u, 0u, 0u, 0u);
    box_groups = groups_for(caster_count());
}
