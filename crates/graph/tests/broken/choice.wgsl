const MODE_SLOW: u32 = 3u;

@fragment fn fragment() -> @location(0) f32 {
    return f32(MODE_SLOW);
}
