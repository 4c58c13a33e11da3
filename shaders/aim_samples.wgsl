// Stage to aim rays at points of the light, for each ray towards its centre one in each part of the
// light's area that this turn takes; one thread per ray, neighbours of one part side by side.
// Cook, Porter, Carpenter, "Distributed Ray Tracing", SIGGRAPH 1984.

#import "shared/groups.wgsl"
#import "shared/aimed_ray.wgsl"
#import "shared/strata.wgsl"

struct Params {
    first: u32,
    samples: u32,
}

var<uniform> params: Params;
var<storage, read> asked_count: u32;
var<storage, read> asked_rays: array<Ray>;
var<storage, read> ray_primitives: array<u32>;
var<storage, read> ray_pixels: array<u32>;
var<storage, read> sample_count: u32;
var<storage, read_write> sample_rays: array<Ray>;
var<storage, read_write> sample_primitives: array<u32>;

@compute @workgroup_size(GROUP_SIZE)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) lane: u32) {
    let thread = thread_number(group, lane);
    if thread >= sample_count {
        return;
    }
    let slot = thread % asked_count;
    let sample = params.first + thread / asked_count;
    let jitter = random_pair(ray_pixels[slot], sample);
    let square = stratum_point(sample, samples_needed(params.samples), jitter);
    sample_rays[thread] = aimed(asked_rays[slot], disk_point(square));
    sample_primitives[thread] = ray_primitives[slot];
}
