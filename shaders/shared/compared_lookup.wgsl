// The entry point of a stage that compares each pixel's receiver with texels of a shadow map; a
// full-screen triangle. The importing file has `fn share_of_light(lookup: Lookup) -> f32`.

#import "shared/depth_bias.wgsl"
#import "shared/map_layers.wgsl"
#import "shared/receiver.wgsl"

struct Lookup {
    pixel: vec2<u32>,
    // w: dot(n, l).
    receiver: vec4<f32>,
    layer: u32,
    fit: MapFit,
    // In texels of the layer; z is the depth there.
    place: vec3<f32>,
}

var shadow_maps: texture_depth_2d_array;
var nearer: sampler_comparison;

@fragment
fn fragment(@builtin(position) centre: vec4<f32>) -> @location(0) f32 {
    let pixel = vec2<u32>(centre.xy);
    let receiver = textureLoad(position, pixel, 0);
    let status = initial_status(pixel, receiver);
    if status != STATUS_UNCERTAIN {
        return f32(initial_visibility(status));
    }
    let layer = layer_of(receiver.xyz);
    let fit = fit_of(layer);
    let place = texel_of(fit, receiver.xyz);
    if is_outside_of(fit, place.xy) {
        return 1.0;
    }
    // A mean is rounded.
    return saturate(share_of_light(Lookup(pixel, receiver, layer, fit, place)));
}

fn bias_of(lookup: Lookup, bias: f32, slope_bias: f32) -> f32 {
    let receiver = lookup.receiver;
    return bias_at(lookup.fit, receiver.xyz, lookup.place, receiver.w, bias, slope_bias);
}
