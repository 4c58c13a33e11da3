// Stage to write what is blurred of the depth of each texel; a full-screen triangle. `powers`: its
// first four moments from the middle of the depth range on, of which a target keeps as many as it
// has channels. Donnelly, Lauritzen,
// "Variance Shadow Maps", I3D 2006, equations 1 and 2; Peters, Klein, "Moment Shadow Mapping", I3D
// 2015, section 2. `warps`: the first two of either warp.

#import "shared/warp.wgsl"

struct Params {
    warp: f32,
}

var<uniform> params: Params;
var shadow_map: texture_depth_2d;

@fragment
fn powers(@builtin(position) centre: vec4<f32>) -> @location(0) vec4<f32> {
    let depth = textureLoad(shadow_map, vec2<u32>(centre.xy), 0) - 0.5;
    let squared = depth * depth;
    return vec4(depth, squared, squared * depth, squared * squared);
}

@fragment
fn warps(@builtin(position) centre: vec4<f32>) -> @location(0) vec4<f32> {
    let depth = textureLoad(shadow_map, vec2<u32>(centre.xy), 0) - 0.5;
    let at = warped(depth, params.warp);
    return vec4(at, at * at).xzyw;
}
