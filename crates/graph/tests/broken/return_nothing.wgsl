@fragment fn fragment() -> @location(0) f32 {
    let value = 1.0;
}
