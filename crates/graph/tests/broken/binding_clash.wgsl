@group(1) @binding(0) var image: texture_2d<f32>;
@group(1) @binding(0) var<storage, read> items: array<f32>;
@group(9) @binding(0) var<storage, read> more: array<f32>;

@fragment fn fragment(@builtin(position) position: vec4<f32>) -> @location(0) f32 {
    return textureLoad(image, vec2<u32>(position.xy), 0).x + items[0] + more[0];
}
