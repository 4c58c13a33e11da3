// Stage to compare each pixel's depth in light space with the nearest texel of the shadow map; a
// full-screen triangle.

#import "shared/map_layers.wgsl" // layer_of, fit_of, texel_of: where a place lies in the map
#import "shared/receiver.wgsl" // `primitive`, `position` and the STATUS_… constants

// The document's params of these names.
struct Params { bias: f32 }
var<uniform> params: Params;

// Bound by its name, without numbers.
var shadow_maps: texture_depth_2d_array;

// In the order of the pass's `color`.
struct Answer {
    @location(0) visibility: u32,
    @location(1) status: u32,
}

@fragment
fn fragment(@builtin(position) centre: vec4<f32>) -> Answer {
    let pixel = vec2<u32>(centre.xy);
    let receiver = textureLoad(position, pixel, 0); // w is dot(n, l)
    var status = initial_status(pixel, receiver);
    // Only pixels that face the light are open until here.
    if status == STATUS_UNCERTAIN {
        status = select(STATUS_SHADOW, STATUS_LIGHT, is_lit(receiver.xyz));
    }
    return Answer(initial_visibility(status), status);
}

// The method itself: change this.
fn is_lit(receiver: vec3<f32>) -> bool {
    let layer = layer_of(receiver);
    let fit = fit_of(layer);
    let place = texel_of(fit, receiver); // column and row, depth
    if is_outside_of(fit, place.xy) {
        return true;
    }
    let stored = textureLoad(shadow_maps, vec2<u32>(place.xy), layer, 0);
    // 1 is what the map was cleared to: no caster, however far.
    return stored >= 1.0 || place.z <= stored + params.bias;
}
