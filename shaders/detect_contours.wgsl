// Stage to compare each pixel's depth in light space with the four texels of the shadow map around
// it; one thread per pixel. All agree: certain. Otherwise, and outside the map: uncertain. Beister,
// Ernst, Stamminger, "A Hybrid GPU-CPU Renderer", 2005.

#import "shared/light_triangle.wgsl"
#import "shared/receiver.wgsl"

struct Params {
    bias: f32,
}

var<uniform> params: Params;
var shadow_map: texture_depth_2d;
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
    let size = textureDimensions(shadow_map);
    let place = light_texel(receiver, f32(size.x));
    if any(place.xy < vec2(0.0)) || any(place.xy >= vec2<f32>(size)) {
        return STATUS_UNCERTAIN;
    }
    // The texels that a bilinear lookup blends.
    let low = vec2<u32>(max(place.xy - 0.5, vec2(0.0)));
    let high = min(vec2<u32>(place.xy + 0.5), size - 1u);
    let lit = u32(is_lit(low, place.z))
        + u32(is_lit(vec2(high.x, low.y), place.z))
        + u32(is_lit(vec2(low.x, high.y), place.z))
        + u32(is_lit(high, place.z));
    return select(select(STATUS_UNCERTAIN, STATUS_SHADOW, lit == 0u), STATUS_LIGHT, lit == 4u);
}

fn is_lit(texel: vec2<u32>, depth: f32) -> bool {
    let stored = textureLoad(shadow_map, texel, 0);
    // 1 is what the map was cleared to: no caster, however far.
    return stored >= 1.0 || depth <= stored + params.bias;
}
