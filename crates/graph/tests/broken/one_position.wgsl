var<storage, read> one: vec4<f32>;

@fragment fn fragment() -> @location(0) f32 {
    return one.x;
}
