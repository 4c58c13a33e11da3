struct Params { radius: u32, step: vec2<i32> }
var<uniform> params: Params;
var source: texture_2d<f32>;

@fragment
fn fragment(@builtin(position) p: vec4<f32>) -> @location(0) vec2<f32> {
    let here = vec2<i32>(p.xy);
    let last = vec2<i32>(textureDimensions(source)) - 1;
    let r = i32(params.radius);
    var sum = vec2(0.0);
    for (var i = -r; i <= r; i++) {
        sum += textureLoad(source, clamp(here + i * params.step, vec2(0), last), 0).xy;
    }
    return sum / f32(2 * r + 1);
}
