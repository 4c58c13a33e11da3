@fragment fn fragment() -> @location(0) f32 {
    return brightness() + 0.5;
}
