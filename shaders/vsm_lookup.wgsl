// Stage to bound the light that arrives at each pixel by mean and variance of the depths around it;
// one thread per pixel. Donnelly, Lauritzen, "Variance Shadow Maps", I3D 2006.

#import "shared/chebyshev.wgsl"
#import "shared/filtered_lookup.wgsl"

struct Params {
    radius: u32,
    min_variance: f32,
    bleed_reduction: f32,
}

var<uniform> params: Params;

fn share_of_light(stored: vec4<f32>, look: Look) -> f32 {
    return chebyshev(stored.xy, look.depth, params.min_variance);
}
