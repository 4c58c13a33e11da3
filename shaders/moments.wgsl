// Stage to write the first two moments of the depth of each texel, of which a target of one channel
// keeps the depth alone; a full-screen triangle. Donnelly, Lauritzen, "Variance Shadow Maps", I3D
// 2006, equations 1 and 2.

var shadow_map: texture_depth_2d;

@fragment
fn fragment(@builtin(position) centre: vec4<f32>) -> @location(0) vec4<f32> {
    let depth = textureLoad(shadow_map, vec2<u32>(centre.xy), 0);
    return vec4(depth, depth * depth, 0.0, 1.0);
}
