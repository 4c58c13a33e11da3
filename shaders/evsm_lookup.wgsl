// Stage to bound the light that arrives at each pixel as vsm does, under two exponential warps of
// depth, by the lesser of both; one thread per pixel. Lauritzen, McCool, "Layered Variance Shadow
// Maps", GI 2008.

#import "shared/chebyshev.wgsl"
#import "shared/filtered_lookup.wgsl"
#import "shared/warp.wgsl"

struct Params {
    radius: u32,
    exponent: f32,
    min_variance: f32,
    bleed_reduction: f32,
}

var<uniform> params: Params;

fn share_of_light(stored: vec4<f32>, look: Look) -> f32 {
    let at = warped(look.depth, params.exponent);
    // A variance of depth becomes one of the warp by its derivative, squared.
    let slope = 2.0 * params.exponent * at;
    let least = params.min_variance * slope * slope;
    return min(chebyshev(stored.xy, at.x, least.x), chebyshev(stored.zw, at.y, least.y));
}
