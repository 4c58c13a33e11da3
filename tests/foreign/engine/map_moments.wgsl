// Each texel of the shadow map, as `fn stored(depth: f32) -> vec4<f32>` of the importing file keeps
// it; a full-screen triangle.

var shadow_map: texture_depth_2d;

@fragment
fn fragment(@builtin(position) centre: vec4<f32>) -> @location(0) vec4<f32> {
    return stored(textureLoad(shadow_map, vec2<u32>(centre.xy), 0));
}
