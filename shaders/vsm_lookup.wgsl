// Stage to bound the light that arrives at each pixel by mean and variance of the depths around it;
// one thread per pixel. Donnelly, Lauritzen, "Variance Shadow Maps", I3D 2006, equations 3 to 5;
// the cut against bleeding is Lauritzen's, "Summed-Area Variance Shadow Maps", GPU Gems 3, 2007.

#import "shared/filtered_lookup.wgsl"

struct Params {
    radius: u32,
    min_variance: f32,
    bleed_reduction: f32,
}

var<uniform> params: Params;

// Chebyshev's inequality: no more than this share of the depths is as great as the receiver's.
fn share_of_light(mean: vec2<f32>, depth: f32) -> f32 {
    let behind = depth - mean.x;
    if behind <= 0.0 {
        return 1.0;
    }
    let variance = max(mean.y - mean.x * mean.x, params.min_variance);
    let share = variance / (variance + behind * behind);
    return saturate((share - params.bleed_reduction) / (1.0 - params.bleed_reduction));
}
