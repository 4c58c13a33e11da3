var<workgroup> sums: array<u32>;

@fragment fn fragment() -> @location(0) f32 {
    return f32(sums[0]);
}
