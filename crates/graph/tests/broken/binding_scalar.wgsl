var seen: texture_2d<u32>;

@fragment fn fragment(@builtin(position) at: vec4<f32>) -> @location(0) vec4<f32> {
    let warm = textureLoad(seen, vec2<u32>(at.xy), 0).x;
    return vec4(warm * vec3(0.8, 0.6, 0.3), 1.0);
}
