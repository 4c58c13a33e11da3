// Stage to carry the share of samples that reach the light back to the asked pixels; one thread per
// asked pixel.

#import "shared/groups.wgsl"
#import "shared/light_area.wgsl"

struct Params {
    samples: u32,
}

var<uniform> params: Params;
var<storage, read> asked_count: u32;
var<storage, read> ray_pixels: array<u32>;
var<storage, read> seen: array<u32>;
var visibility: texture_storage_2d<r32float, write>;

@compute @workgroup_size(GROUP_SIZE)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) lane: u32) {
    let slot = thread_number(group, lane);
    if slot >= asked_count {
        return;
    }
    let width = textureDimensions(visibility).x;
    let pixel = vec2(ray_pixels[slot] % width, ray_pixels[slot] / width);
    let share = f32(seen[slot]) / f32(samples_needed(params.samples));
    // No share of light.
    let is_unanswered = (seen[slot] & UNANSWERED_SAMPLE) != 0u;
    textureStore(visibility, pixel, vec4(select(share, -1.0, is_unanswered)));
}
