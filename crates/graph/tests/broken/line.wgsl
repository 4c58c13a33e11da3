var image: texture_1d<f32>;

@fragment fn fragment() -> @location(0) f32 {
    return textureLoad(image, 0u, 0).x;
}
