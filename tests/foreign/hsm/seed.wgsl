var shadow_map: texture_depth_2d;
@fragment fn fragment(@builtin(position) p: vec4<f32>) -> @location(0) vec2<f32> {
    return vec2(textureLoad(shadow_map, vec2<u32>(p.xy), 0));
}
