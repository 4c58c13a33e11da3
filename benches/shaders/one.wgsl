var a: texture_2d<f32>;
struct Params { strength: f32 }
var<uniform> params: Params;
@fragment fn one(@builtin(position) centre: vec4<f32>) -> @location(0) vec4<f32> {
    return textureLoad(a, vec2<u32>(centre.xy), 0) * params.strength;
}
