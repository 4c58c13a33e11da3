// The mean of texels, each of a weight. Where `exponent` is not 0, a texel is a depth that stands
// for exp(exponent · depth): the mean is that of the exponentials, as a depth again. It is summed
// relative to the greatest so far, so that none is too large for f32. Salvi, "Rendering Filtered
// Shadows with Exponential Shadow Maps", ShaderX6, 2008.

struct Mean {
    sum: vec4<f32>,
    weight: f32,
    greatest: f32,
}

fn no_texel() -> Mean {
    return Mean(vec4(0.0), 0.0, -1e30);
}

fn with_texel(mean: Mean, texel: vec4<f32>, weight: f32, exponent: f32) -> Mean {
    let summed = mean.weight + weight;
    if exponent == 0.0 {
        return Mean(mean.sum + weight * texel, summed, 0.0);
    }
    let greatest = max(mean.greatest, texel.x);
    let kept = mean.sum * exp(exponent * (mean.greatest - greatest));
    return Mean(kept + weight * exp(exponent * (texel.x - greatest)), summed, greatest);
}

fn mean_texel(mean: Mean, exponent: f32) -> vec4<f32> {
    if exponent == 0.0 {
        return mean.sum / mean.weight;
    }
    return mean.greatest + log(mean.sum / mean.weight) / exponent;
}
