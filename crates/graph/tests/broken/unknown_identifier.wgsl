@fragment fn fragment() -> @location(0) f32 {
    return brightness * 2.0;
}
