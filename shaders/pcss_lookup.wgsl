// Stage to filter the shadow map around each pixel as widely as the light's extent and the depth of
// what blocks it ask; a full-screen triangle. Fernando, "Percentage-Closer Soft Shadows", SIGGRAPH
// 2005 sketches: blockers are searched for within the light's cone, their mean depth gives the
// penumbra by similar triangles, which is filtered. Taps lie in the plane of the receiver, one in
// each of as many parts of equal area.

#import "shared/depth_bias.wgsl"
#import "shared/geometry.wgsl"
#import "shared/light_area.wgsl"
#import "shared/map_layers.wgsl"
#import "shared/receiver.wgsl"
#import "shared/strata.wgsl"

struct Params {
    blockers: u32,
    taps: u32,
    near: f32,
    bias: f32,
    slope_bias: f32,
}

var<uniform> params: Params;
var shadow_maps: texture_depth_2d_array;
var nearer: sampler_comparison;

struct Receiver {
    place: vec3<f32>,
    to_light: vec3<f32>,
    // What its plane rises towards the light per unit across.
    slope: vec3<f32>,
    bias: f32,
    jitter: vec2<f32>,
}

struct Tap {
    layer: u32,
    // 0 to 1 across the layer; z: the plane's depth there, less the bias.
    place: vec3<f32>,
    is_outside: bool,
}

// Tap `index` of `count` over the penumbra of a blocker that lies `spread` before the receiver:
// under a lamp as a share of its own way from the light.
fn tap(receiver: Receiver, index: u32, count: u32, spread: f32) -> Tap {
    let point = disk_point(stratum_point(index, count, receiver.jitter));
    let across = spread * across_light(point, receiver.to_light);
    let at = receiver.place + across - receiver.to_light * dot(across, receiver.slope);
    let layer = layer_of(at);
    let fit = fit_of(layer);
    let place = texel_of(fit, at);
    return Tap(layer, vec3(place.xy / fit.size, place.z - receiver.bias), is_outside_of(fit, place.xy));
}

fn spread_of(depth: f32, blocker: f32) -> f32 {
    if light_kind == LIGHT_DIRECTIONAL {
        return (depth - blocker) * light.extent.z;
    }
    return (depth - blocker) / blocker;
}

@fragment
fn fragment(@builtin(position) centre: vec4<f32>) -> @location(0) f32 {
    let pixel = vec2<u32>(centre.xy);
    let place = textureLoad(position, pixel, 0);
    let status = initial_status(pixel, place);
    if status != STATUS_UNCERTAIN {
        return f32(initial_visibility(status));
    }
    let to_light = to_light_from(place.xyz);
    let number = pixel.y * textureDimensions(position).x + pixel.x;
    let slope = plane_slope(textureLoad(primitive, pixel, 0).x, to_light);
    let fit = fit_of(layer_of(place.xyz));
    let at = texel_of(fit, place.xyz);
    let bias = bias_at(fit, place.xyz, at, place.w, params.bias, params.slope_bias);
    let receiver = Receiver(place.xyz, to_light, slope, bias, random_pair(number, 0u));

    let depth = at.z;
    let search = spread_of(depth, select(params.near * depth, 0.0, light_kind == LIGHT_DIRECTIONAL));
    let count = samples_needed(params.blockers);
    var found = 0.0;
    var sum = 0.0;
    for (var i = 0u; i < count; i++) {
        let tap = tap(receiver, i, count, search);
        let texel = vec2<i32>(tap.place.xy * f32(textureDimensions(shadow_maps).x));
        let stored = textureLoad(shadow_maps, texel, tap.layer, 0);
        if !tap.is_outside && stored < tap.place.z {
            found += 1.0;
            sum += spread_of(tap.place.z, stored);
        }
    }
    if found == 0.0 {
        return 1.0;
    }
    let taps = samples_needed(params.taps);
    var lit = 0.0;
    for (var i = 0u; i < taps; i++) {
        let tap = tap(receiver, i, taps, sum / found);
        if tap.is_outside {
            lit += 1.0;
            continue;
        }
        lit += textureSampleCompareLevel(shadow_maps, nearer, tap.place.xy, tap.layer, tap.place.z);
    }
    return saturate(lit / f32(taps));
}

// None of a plane that the light grazes, or of a receiver whose primitive is not known.
fn plane_slope(id: u32, to_light: vec3<f32>) -> vec3<f32> {
    let a = corner_position(3u * id);
    let normal = cross(corner_position(3u * id + 1u) - a, corner_position(3u * id + 2u) - a);
    let facing = dot(normal, to_light);
    return select(normal / facing, vec3(0.0), abs(facing) <= 0.02 * length(normal));
}
