var image: texture_2d<f32>;
var smooth_sampler: sampler;

@fragment fn fragment(@builtin(position) position: vec4<f32>) -> @location(0) f32 {
    return textureSample(image, smooth_sampler, position.xy * 0.01).x;
}
