// Stage to smooth `image`.
var image: texture_2d<f32>;

@fragment fn fragment(@builtin(position) position: vec4<f32>) -> @location(0) f32 {
    return textureLoad(image, vec2<u32>(position.xy), 0).x;
}
