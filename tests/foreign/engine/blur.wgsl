// Stage to average 2 · radius + 1 texels along one axis; a full-screen triangle.

struct Params { radius: u32 }
var<uniform> params: Params;
var source: texture_2d<f32>;

@fragment
fn x(@builtin(position) centre: vec4<f32>) -> @location(0) vec4<f32> {
    return mean(vec2<i32>(centre.xy), vec2(1, 0));
}

@fragment
fn y(@builtin(position) centre: vec4<f32>) -> @location(0) vec4<f32> {
    return mean(vec2<i32>(centre.xy), vec2(0, 1));
}

fn mean(here: vec2<i32>, direction: vec2<i32>) -> vec4<f32> {
    let last = vec2<i32>(textureDimensions(source)) - 1;
    let radius = i32(params.radius);
    var sum = vec4(0.0);
    for (var i = -radius; i <= radius; i++) {
        sum += textureLoad(source, clamp(here + i * direction, vec2(0), last), 0);
    }
    return sum / f32(2 * radius + 1);
}
