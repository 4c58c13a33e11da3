@fragment fn fragment(@builtin(position) position: vec4<f32>) -> @location(0) u32 {
    return u32(position.x);
}
