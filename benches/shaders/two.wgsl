var a: texture_2d<f32>;
var b: texture_2d<f32>;
@fragment fn two(@builtin(position) centre: vec4<f32>) -> @location(0) vec4<f32> {
    let pixel = vec2<u32>(centre.xy);
    return textureLoad(a, pixel, 0) + textureLoad(b, pixel, 0);
}
