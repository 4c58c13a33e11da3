var<storage, read> one: u32;

@fragment fn fragment() -> @location(0) f32 {
    return f32(one);
}
