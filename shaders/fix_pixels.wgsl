// Stage to carry the tracer's answers back to the uncertain pixels; one thread per ray.

#import "shared/groups.wgsl"
#import "shared/ray.wgsl"
#import "shared/ids.wgsl"

var<storage, read> ray_count: u32;
var<storage, read> ray_pixels: array<u32>;
var<storage, read> hits: array<Hit>;
var visibility: texture_storage_2d<r32uint, write>;

@compute @workgroup_size(GROUP_SIZE)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) lane: u32) {
    let slot = thread_number(group, lane);
    if slot >= ray_count || ray_pixels[slot] == NO_PIXEL {
        return;
    }
    let width = textureDimensions(visibility).x;
    let pixel = vec2(ray_pixels[slot] % width, ray_pixels[slot] / width);
    let primitive = hits[slot].primitive;
    let answer = select(0u, 1u, primitive == NO_PRIMITIVE);
    let shown = select(answer, VISIBILITY_UNANSWERED, primitive == UNANSWERED);
    textureStore(visibility, pixel, vec4(shown));
}
