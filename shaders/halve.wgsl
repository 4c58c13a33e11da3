// Stage to make each texel the mean of what it covers of the mip above; a full-screen triangle.

#import "shared/mean.wgsl"

struct Params {
    exponent: f32,
}

var<uniform> params: Params;
var source: texture_2d<f32>;

@fragment
fn fragment(@builtin(position) centre: vec4<f32>) -> @location(0) vec4<f32> {
    // Two texels and, of a mip with an odd edge, a part of the third.
    let edge = textureDimensions(source).x;
    let scale = f32(edge) / f32(max(edge / 2u, 1u));
    let low = (centre.xy - 0.5) * scale;
    let first = vec2<u32>(low);
    var mean = no_texel();
    for (var y = 0u; y < 3u; y++) {
        for (var x = 0u; x < 3u; x++) {
            let at = first + vec2(x, y);
            let begin = vec2<f32>(at);
            let covered = min(begin + 1.0, low + scale) - max(begin, low);
            if all(covered > vec2(0.0)) && all(at < vec2(edge)) {
                let texel = textureLoad(source, at, 0);
                mean = with_texel(mean, texel, covered.x * covered.y, params.exponent);
            }
        }
    }
    return mean_texel(mean, params.exponent);
}
