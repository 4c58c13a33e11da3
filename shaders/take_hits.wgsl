// Stage to hand the hits that an engine left in memory to where a `Trace` pass takes them; one
// thread per ray.

#import "shared/groups.wgsl"
#import "shared/ray_buffers.wgsl"

var<storage, read> count: u32;
var<storage, read> written_hits: array<Hit>;

@compute @workgroup_size(GROUP_SIZE)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) lane: u32) {
    let index = thread_number(group, lane);
    if index < min(min(count, ray_limit()), arrayLength(&written_hits)) {
        take(index, written_hits[index]);
    }
}
