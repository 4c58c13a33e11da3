var seen: texture_2d<f32>;

@fragment fn fragment() -> @location(0) f32 {
    return textureLoad(seen, vec2(0u), 0).x;
}
