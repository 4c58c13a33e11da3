const GRAY: f32 = 0.5;

@fragment fn fragment() -> @location(0) f32 {
    return GRAY;
}
