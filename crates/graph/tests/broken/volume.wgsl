var image: texture_3d<f32>;

@fragment fn fragment(@builtin(position) position: vec4<f32>) -> @location(0) f32 {
    return textureLoad(image, vec3<u32>(0u), 0).x;
}
