var a: texture_2d<f32>;
@vertex fn corner(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> {
    return vec4<f32>(f32(index & 1u), f32(index >> 1u), 0.5, 1.0);
}
@fragment fn colour(@builtin(position) centre: vec4<f32>) -> @location(0) vec4<f32> {
    return textureLoad(a, vec2<u32>(centre.xy), 0);
}
