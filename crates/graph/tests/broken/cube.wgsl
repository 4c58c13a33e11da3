var image: texture_cube<f32>;
var nearest: sampler;

@fragment fn fragment(@builtin(position) position: vec4<f32>) -> @location(0) f32 {
    return textureSample(image, nearest, position.xyz).x;
}
