var<storage, read> one: vec4<u32>;

@fragment fn fragment() -> @location(0) f32 {
    return f32(one.x);
}
