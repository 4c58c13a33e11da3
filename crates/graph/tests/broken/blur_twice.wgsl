// Stage to smooth `image` in two ways.
var image: texture_2d<f32>;

struct Smooth {
    @location(0) little: f32,
    @location(1) much: f32,
}

@fragment fn fragment(@builtin(position) position: vec4<f32>) -> Smooth {
    let texel = textureLoad(image, vec2<u32>(position.xy), 0).x;
    return Smooth(texel, texel * 0.5);
}
