@fragment fn fragment(@builtin(position) at: vec4<f32>) -> @location(0) f32 {
    let pixel = vec2<u32>(at.xy);
    return f32(pixel.x) * pixel;
}
