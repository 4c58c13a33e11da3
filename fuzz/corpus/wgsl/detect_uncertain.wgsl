// Stage to compare each pixel's depth in light space with the two layers of the map; one thread per pixel. Both say light, or both
// shadow: certain. Otherwise, and outside the map: uncertain. Hertel, Hormann, Westermann 2009.

#import "shared/light_triangle.wgsl"
#import "shared/ids.wgsl"

var primitive: texture_2d<u32>;
var position: texture_2d<f32>;
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
    var pixel_status = STATUS_BACKGROUND;
    if textureLoad(primitive, pixel, 0).x != NO_PRIMITIVE {
        let receiver = textureLoad(position, pixel, 0);
        pixel_status = STATUS_FACING_AWAY;
        if receiver.w > 0.0 {
            pixel_status = compare(receiver.xyz);
        }
    }
    textureStore(status, pixel, vec4(pixel_status));
    textureStore(visibility, pixel, vec4(shown(pixel_status)));
}

fn compare(receiver: vec3<f32>) -> u32 {
    let size = textureDimensions(big);
    let place = light_texel(receiver, f32(size.x));
    let error = rounding(receiver);
    // Half of the slack is the corners'.
    if any(place.xy < vec2(0.0)) || any(place.xy >= vec2<f32>(size)) || error.x * f32(size.x) > 0.5 * SLACK {
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

// Bound on the rounding of a point in light space, in shares of the map's edge and of its depth: 4
// ulp of all that is summed up.
fn rounding(position: vec3<f32>) -> vec2<f32> {
    let matrix = transpose(light.clip_from_relative);
    let size = abs(position) + abs(light.centre.xyz);
    let across = max(dot(abs(matrix[0].xyz), size), dot(abs(matrix[1].xyz), size));
    let along = dot(abs(matrix[2].xyz), size);
    return 2.3841858e-7 * vec2(across + 1.0, along + 1.0);
}
