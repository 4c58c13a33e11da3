// Stage to count the texels of one triangle.
var<storage, read_write> total: atomic<u32>;

@vertex fn vertex(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> {
    return vec4<f32>(f32(index & 1u) * 4.0 - 1.0, f32(index >> 1u) * 4.0 - 1.0, 0.5, 1.0);
}

@fragment fn fragment() {
    atomicAdd(&total, 1u);
}
