var depth: texture_depth_2d;
var shadow_sampler: sampler_comparison;

@fragment fn fragment(@builtin(position) position: vec4<f32>) -> @location(0) f32 {
    return textureSampleCompare(depth, shadow_sampler, position.xy * 0.01, 0.5);
}
