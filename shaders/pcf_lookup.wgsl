// Stage to compare each pixel's depth in light space with a square of texels of the shadow map, and
// to answer with the share of them that lie behind it; a full-screen triangle. Reeves, Salesin,
// Cook, "Rendering Antialiased Shadows with Depth Maps", SIGGRAPH 1987, with every texel of the
// region instead of some by chance.

#import "shared/compared_lookup.wgsl"

const COMPARE_SAMPLER: u32 = 0u;

struct Params {
    radius: u32,
    compare: u32,
    bias: f32,
    slope_bias: f32,
}

var<uniform> params: Params;

fn share_of_light(lookup: Lookup) -> f32 {
    // The plane rises over all of the square.
    let slope_bias = params.slope_bias * f32(params.radius + 1u);
    let depth = lookup.place.z - bias_of(lookup, params.bias, slope_bias);
    if params.compare == COMPARE_SAMPLER {
        return sampled(lookup.place.xy, lookup.layer, depth);
    }
    return by_hand(lookup.place.xy, lookup.layer, depth);
}

// The mean of 2 · radius + 1 bilinear comparisons in each direction.
fn sampled(place: vec2<f32>, layer: u32, depth: f32) -> f32 {
    let radius = i32(params.radius);
    var lit = 0.0;
    for (var y = -radius; y <= radius; y++) {
        for (var x = -radius; x <= radius; x++) {
            let at = (place + vec2(f32(x), f32(y))) / map_fit.size;
            lit += textureSampleCompareLevel(shadow_maps, nearer, at, layer, depth);
        }
    }
    return lit / f32((2 * radius + 1) * (2 * radius + 1));
}

// The same, each texel compared once: those between count whole, the outermost by what a square of
// 2 · radius + 1 texels around the receiver covers of them.
fn by_hand(place: vec2<f32>, layer: u32, depth: f32) -> f32 {
    let radius = i32(params.radius);
    let end = vec2<i32>(textureDimensions(shadow_maps)) - 1;
    let first = vec2<i32>(floor(place - 0.5)) - radius;
    let last = 2 * radius + 1;
    let part = fract(place - 0.5);
    var lit = 0.0;
    for (var y = 0; y <= last; y++) {
        for (var x = 0; x <= last; x++) {
            let step = vec2(x, y);
            let begun = select(vec2(1.0), 1.0 - part, step == vec2(0));
            let cover = select(begun, part, step == vec2(last));
            let stored = textureLoad(shadow_maps, clamp(first + step, vec2(0), end), layer, 0);
            lit += cover.x * cover.y * select(0.0, 1.0, depth <= stored);
        }
    }
    return lit / f32(last * last);
}
