// Stage to compare each pixel's depth in light space with the nearest texel of the shadow map; a
// full-screen triangle. Williams, "Casting Curved Shadows on Curved Surfaces", SIGGRAPH 1978.

#import "shared/depth_bias.wgsl"
#import "shared/map_layers.wgsl"
#import "shared/receiver.wgsl"
#import "shared/unmoved.wgsl"

struct Params {
    bias: f32,
    slope_bias: f32,
}

var<uniform> params: Params;
var shadow_maps: texture_depth_2d_array;

struct Answer {
    @location(0) visibility: u32,
    @location(1) status: u32,
}

@fragment
fn fragment(@builtin(position) centre: vec4<f32>) -> Answer {
    let status = compare(vec2<u32>(centre.xy));
    return Answer(initial_visibility(status), status);
}

fn compare(pixel: vec2<u32>) -> u32 {
    let receiver = textureLoad(position, pixel, 0);
    let status = initial_status(pixel, receiver);
    if status != STATUS_UNCERTAIN {
        return status;
    }
    return select(STATUS_SHADOW, STATUS_LIGHT, is_lit(pixel, receiver.xyz, receiver.w));
}

fn is_lit(pixel: vec2<u32>, seen: vec3<f32>, n_dot_l: f32) -> bool {
    let layer = layer_of(seen);
    let fit = fit_of(layer);
    let receiver = moved(fit, pixel, seen);
    let place = texel_of(fit, receiver);
    if is_outside_of(fit, place.xy) {
        return true;
    }
    let stored = textureLoad(shadow_maps, vec2<u32>(place.xy), layer, 0);
    // 1 is what the map was cleared to: no caster, however far.
    let bias = bias_at(fit, receiver, place, n_dot_l, params.bias, params.slope_bias);
    return stored >= 1.0 || place.z <= stored + bias;
}
