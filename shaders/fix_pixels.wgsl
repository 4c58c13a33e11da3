// Stage to carry what rays met from their list to the uncertain pixels; one thread per ray.

#import "shared/groups.wgsl"
#import "shared/pixel_list.wgsl"

var<storage, read> ray_count: u32;
var<storage, read> ray_pixels: array<u32>;
var visibility: texture_storage_2d<r32uint, write>;

@compute @workgroup_size(GROUP_SIZE)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) lane: u32) {
    let slot = thread_number(group, lane);
    if slot >= ray_count {
        return;
    }
    let entry = ray_pixels[slot];
    let outcome = entry & ~PLACE;
    if outcome == IGNORED {
        return;
    }
    let answer = select(1u, 0u, outcome == HAS_HIT);
    let shown = select(answer, VISIBILITY_UNANSWERED, outcome == HAS_NO_ANSWER);
    textureStore(visibility, listed_pixel(entry, textureDimensions(visibility).x), vec4(shown));
}
