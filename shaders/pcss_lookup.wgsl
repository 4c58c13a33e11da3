// Stage to filter the shadow map around each pixel as widely as the light's extent and the depth of
// its blockers ask; a full-screen triangle. Fernando, "Percentage-Closer Soft Shadows", SIGGRAPH
// 2005 sketches: a search for blockers, their mean penumbra by similar triangles, a filter of that
// size. Taps lie on the receiver's plane, one in each of as many parts of equal area.

#import "shared/compared_lookup.wgsl"
#import "shared/geometry.wgsl"
#import "shared/light_area.wgsl"
#import "shared/strata.wgsl"

struct Params {
    blockers: u32,
    taps: u32,
    near: f32,
    bias: f32,
    slope_bias: f32,
}

var<uniform> params: Params;

fn share_of_light(lookup: Lookup) -> f32 {
    let pixel = lookup.pixel;
    let receiver = lookup.receiver.xyz;
    let bias = bias_of(lookup, params.bias, params.slope_bias);
    let axes = light_on_plane(textureLoad(primitive, pixel, 0).x, to_light_from(receiver));
    let jitter = random_pair(pixel.y * textureDimensions(position).x + pixel.x, 0u);

    let search = widest_penumbra(lookup.place.z);
    let blockers = samples_needed(params.blockers);
    var found = 0.0;
    var sum = 0.0;
    for (var i = 0u; i < blockers; i++) {
        let at = receiver + axes * (search * disk_point(stratum_point(i, blockers, jitter)));
        let tap = texel_of(fit_of(layer_of(at)), at);
        let texel = vec2<u32>(clamp(tap.xy, vec2(0.0), vec2(lookup.fit.size - 1.0)));
        let width = penumbra(tap.z - bias, textureLoad(shadow_maps, texel, layer_of(at), 0));
        found += select(0.0, 1.0, width > 0.0);
        sum += max(width, 0.0);
    }
    if found == 0.0 {
        return 1.0;
    }
    let taps = samples_needed(params.taps);
    var lit = 0.0;
    for (var i = 0u; i < taps; i++) {
        let at = receiver + axes * (sum / found * disk_point(stratum_point(i, taps, jitter)));
        let tap = texel_of(fit_of(layer_of(at)), at);
        let place = tap.xy / lookup.fit.size;
        lit += textureSampleCompareLevel(shadow_maps, nearer, place, layer_of(at), tap.z - bias);
    }
    return lit / f32(taps);
}

// Half width of the penumbra of a blocker, in half widths of the light: of a directional light in
// those at distance 1. Not above 0 where nothing is blocked.
fn penumbra(receiver: f32, blocker: f32) -> f32 {
    if light_kind == LIGHT_DIRECTIONAL {
        return (receiver - blocker) * light.extent.z;
    }
    return (receiver - blocker) / max(blocker, params.near * receiver);
}

// The half width for the nearest blocker that counts: one at the map's front, or at the share
// `near` of the way from a lamp to the receiver.
fn widest_penumbra(receiver: f32) -> f32 {
    return penumbra(receiver, select(params.near * receiver, 0.0, light_kind == LIGHT_DIRECTIONAL));
}

// The axes of the light's disk, moved along the light into the plane of a primitive, but for one
// that the light grazes or that is not known.
fn light_on_plane(id: u32, to_light: vec3<f32>) -> mat2x3<f32> {
    let right = across_light(vec2(1.0, 0.0), to_light);
    let up = across_light(vec2(0.0, 1.0), to_light);
    if id == UNKNOWN_PRIMITIVE {
        return mat2x3(right, up);
    }
    let a = corner_position(3u * id);
    let normal = cross(corner_position(3u * id + 1u) - a, corner_position(3u * id + 2u) - a);
    let facing = dot(normal, to_light);
    let slope = select(normal / facing, vec3(0.0), abs(facing) <= 0.02 * length(normal));
    return mat2x3(right - to_light * dot(right, slope), up - to_light * dot(up, slope));
}
