var a: texture_2d<f32>;
@fragment fn half(@builtin(position) centre: vec4<f32>) -> @location(0) vec4<f32> {
    return textureLoad(a, vec2<u32>(centre.xy), 0) * 0.5;
}
