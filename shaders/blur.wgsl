// Stage to replace each texel by the mean of those around it along one axis, a box of
// 2 · radius + 1; a full-screen triangle.

#import "shared/mean.wgsl"

struct Params {
    radius: u32,
    direction: vec2<i32>,
    exponent: f32,
}

var<uniform> params: Params;
var source: texture_2d<f32>;

@fragment
fn fragment(@builtin(position) centre: vec4<f32>) -> @location(0) vec4<f32> {
    let last = vec2<i32>(textureDimensions(source)) - 1;
    let radius = i32(params.radius);
    var mean = no_texel();
    for (var step = -radius; step <= radius; step++) {
        let at = clamp(vec2<i32>(centre.xy) + step * params.direction, vec2(0), last);
        mean = with_texel(mean, textureLoad(source, at, 0), 1.0, params.exponent);
    }
    return mean_texel(mean, params.exponent);
}
