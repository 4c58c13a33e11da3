var image: texture_2d<f32>;
@fragment fn fragment() -> @location(0) f32 {
    return 1.0;
}
