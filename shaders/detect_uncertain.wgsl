// Stage to compare each pixel's depth in light space with the two layers of the map; one thread per pixel. Both say light, or both
// shadow: certain. Otherwise, and outside the map: uncertain. Hertel, Hormann, Westermann 2009.

#import "shared/light_triangle.wgsl"
#import "shared/receiver.wgsl"

var big: texture_depth_2d;
var small: texture_depth_2d;
var visibility: texture_storage_2d<r32uint, write>;
var status: texture_storage_2d<r32uint, write>;

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) thread: vec3<u32>) {
    let pixel = thread.xy;
    if any(pixel >= textureDimensions(primitive)) {
        return;
    }
    let receiver = textureLoad(position, pixel, 0);
    var pixel_status = status_unasked(pixel, receiver);
    if pixel_status == STATUS_UNCERTAIN {
        pixel_status = compare(receiver.xyz);
    }
    textureStore(status, pixel, vec4(pixel_status));
    textureStore(visibility, pixel, vec4(shown(pixel_status)));
}

fn compare(receiver: vec3<f32>) -> u32 {
    let size = textureDimensions(big);
    let place = light_texel(receiver, f32(size.x));
    let error = light_rounding(receiver);
    // What may lie in another texel than it seems, even one grown by the slack, is not compared.
    if any(place.xy < vec2(0.0)) || any(place.xy >= vec2<f32>(size)) || error.x * f32(size.x) > SLACK {
        return STATUS_UNCERTAIN;
    }
    let texel = vec2<u32>(place.xy);
    let in_big = textureLoad(big, texel, 0);
    let in_small = textureLoad(small, texel, 0);
    // 1 is what a layer was cleared to: nothing, however far.
    let lit = (in_big >= 1.0 || place.z + error.y <= in_big) && (in_small >= 1.0 || place.z + error.y <= in_small);
    let shadowed = in_big < 1.0 && place.z - error.y > in_big && in_small < 1.0 && place.z - error.y > in_small;
    return select(select(STATUS_UNCERTAIN, STATUS_SHADOW, shadowed), STATUS_LIGHT, lit);
}
