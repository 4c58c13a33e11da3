var depth: texture_depth_2d;

@fragment fn fragment() -> @location(0) f32 {
    return textureLoad(depth, vec2<u32>(0u), 0);
}
