override brightness: f32;

@fragment fn fragment() -> @location(0) f32 {
    return brightness;
}
