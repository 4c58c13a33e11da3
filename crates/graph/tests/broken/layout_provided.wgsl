var<storage, read> scene_positions: array<f32>;

@fragment fn fragment(@builtin(position) position: vec4<f32>) -> @location(0) f32 {
    return scene_positions[u32(position.x)];
}
