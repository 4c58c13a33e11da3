// Stage to let through less light the farther each pixel lies behind the depths around it;
// one thread per pixel. Annen, Mertens, Seidel, Flerackers, Kautz, "Exponential Shadow Maps",
// GI 2008; the map holds logarithms: Salvi, "Rendering Filtered Shadows with Exponential Shadow
// Maps", ShaderX6, 2008.

#import "shared/filtered_lookup.wgsl"

struct Params {
    radius: u32,
    exponent: f32,
    bleed_reduction: f32,
}

var<uniform> params: Params;

fn share_of_light(stored: vec4<f32>, look: Look) -> f32 {
    return exp(params.exponent * (stored.x - look.depth));
}
