var<storage, read> items: array<f32>;

@fragment fn fragment(@builtin(position) position: vec4<f32>) -> @location(0) f32 {
    return items[u32(position.x)];
}
