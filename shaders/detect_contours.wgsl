// Stage to compare each pixel's depth in light space with the texels of the shadow map around it;
// one thread per pixel. All agree: certain. Otherwise, and outside the map: uncertain. Beister,
// Ernst, Stamminger, "A Hybrid GPU-CPU Renderer", 2005.

#import "shared/classify.wgsl"
#import "shared/footprint.wgsl"
#import "shared/map_layers.wgsl"

struct Params {
    bias: f32,
    footprint: u32,
}

var<uniform> params: Params;
var shadow_maps: texture_depth_2d_array;

fn compare(receiver: vec3<f32>) -> u32 {
    let layer = layer_of(receiver);
    let fit = fit_of(layer);
    let place = texel_of(fit, receiver);
    if is_outside_of(fit, place.xy) {
        return STATUS_UNCERTAIN;
    }
    let asked = footprint(fit, place.xy, params.footprint);
    let taps = taps(shadow_maps, layer, asked, place.z, params.bias);
    return select(select(STATUS_UNCERTAIN, STATUS_SHADOW, taps.shadowed), STATUS_LIGHT, taps.lit);
}
