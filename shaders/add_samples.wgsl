// Stage to count the samples of a turn that reach the light; one thread per asked pixel.

#import "shared/groups.wgsl"
#import "shared/ray.wgsl"
#import "shared/ids.wgsl"
#import "shared/light_area.wgsl"

var<storage, read> asked_count: u32;
var<storage, read> sample_count: u32;
var<storage, read> hits: array<Hit>;
var<storage, read_write> seen: array<u32>;

@compute @workgroup_size(GROUP_SIZE)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) lane: u32) {
    let slot = thread_number(group, lane);
    if slot >= asked_count {
        return;
    }
    var sum = seen[slot];
    for (var ray = slot; ray < sample_count; ray += asked_count) {
        let primitive = hits[ray].primitive;
        sum += select(0u, 1u, primitive == NO_PRIMITIVE);
        sum |= select(0u, UNANSWERED_SAMPLE, primitive == UNANSWERED);
    }
    seen[slot] = sum;
}
