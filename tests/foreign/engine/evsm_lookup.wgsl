#import "map_lookup.wgsl"
#import "evsm_warp.wgsl"

struct Params { radius: u32, positive: f32, negative: f32, min_variance: f32, bias: f32, bleed: f32 }
var<uniform> params: Params;

fn chebyshev(mean: f32, square: f32, at: f32, least: f32) -> f32 {
    if at <= mean {
        return 1.0;
    }
    let variance = max(square - mean * mean, least);
    return clamp((variance / (variance + (at - mean) * (at - mean)) - params.bleed) / (1.0 - params.bleed), 0.0, 1.0);
}

fn light_share(stored: vec4<f32>, depth: f32) -> f32 {
    let w = warped(depth - params.bias);
    // A spread of depth becomes one of the warp by its derivative.
    let spread = params.min_variance * 2.0 * vec2(params.positive, params.negative) * w;
    let least = spread * spread;
    return min(chebyshev(stored.x, stored.z, w.x, least.x), chebyshev(stored.y, stored.w, w.y, least.y));
}
