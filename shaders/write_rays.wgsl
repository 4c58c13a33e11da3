// Stage to write the rays that a `Trace` pass asks for to memory, for engines and files that take
// them from there; one thread per ray.

#import "shared/groups.wgsl"
#import "shared/ray_buffers.wgsl"

var<storage, read> count: u32;
var<storage, read_write> written_rays: array<Ray>;
var<storage, read_write> written_skip: array<u32>;

@compute @workgroup_size(GROUP_SIZE)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) lane: u32) {
    let index = thread_number(group, lane);
    if index < min(min(count, ray_limit()), arrayLength(&written_rays)) {
        let asked = ray_of(index);
        written_rays[index] = asked.ray;
        written_skip[index] = asked.skipped;
    }
}
