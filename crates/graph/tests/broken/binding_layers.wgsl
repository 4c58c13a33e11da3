var seen: texture_2d<f32>;

@fragment fn fragment(@builtin(position) at: vec4<f32>) -> @location(0) f32 {
    return textureLoad(seen, vec2<u32>(at.xy), 1, 0).x;
}
