var<storage, read_write> items: array<u32>;

@vertex fn vertex(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> {
    items[index] = index;
    return vec4<f32>(f32(index), 0.0, 0.0, 1.0);
}

@fragment fn fragment() -> @location(0) f32 {
    return 1.0;
}
