// Stage to compare each pixel's depth in light space with the outer and the inner depth of the map;
// one thread per pixel. Both say light, or both shadow: certain. Otherwise, and outside the map:
// uncertain. Hertel, Hormann, Westermann 2009.

#import "shared/light_triangle.wgsl"
#import "shared/receiver.wgsl"

var outer: texture_depth_2d;
var inner: texture_depth_2d;
var visibility: texture_storage_2d<r32uint, write>;
var status: texture_storage_2d<r32uint, write>;

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) thread: vec3<u32>) {
    let pixel = thread.xy;
    if any(pixel >= textureDimensions(primitive)) {
        return;
    }
    let receiver = textureLoad(position, pixel, 0);
    var pixel_status = initial_status(pixel, receiver);
    if pixel_status == STATUS_UNCERTAIN {
        pixel_status = compare(receiver.xyz);
    }
    textureStore(status, pixel, vec4(pixel_status));
    textureStore(visibility, pixel, vec4(initial_visibility(pixel_status)));
}

fn compare(receiver: vec3<f32>) -> u32 {
    let size = textureDimensions(outer);
    let place = light_texel(receiver, f32(size.x));
    let error = light_space_error_bound(receiver);
    // What may lie in another texel than it seems, even one grown by the slack, is not compared.
    let outside = any(place.xy < vec2(0.0)) || any(place.xy >= vec2<f32>(size));
    if outside || error.x * f32(size.x) > SLACK {
        return STATUS_UNCERTAIN;
    }
    let texel = vec2<u32>(place.xy);
    let in_outer = textureLoad(outer, texel, 0);
    let in_inner = textureLoad(inner, texel, 0);
    // 1 is what both were cleared to: no caster, however far.
    let far = place.z + error.y;
    let near = place.z - error.y;
    let lit = (in_outer >= 1.0 || far <= in_outer) && (in_inner >= 1.0 || far <= in_inner);
    let shadowed = in_outer < 1.0 && near > in_outer && in_inner < 1.0 && near > in_inner;
    return select(select(STATUS_UNCERTAIN, STATUS_SHADOW, shadowed), STATUS_LIGHT, lit);
}
