// Where a square shadow map lies across light space: any affine map of it will do, the same for
// receivers and casters. Made by shared/fit_map.ron.

#import "shared/light.wgsl"

struct MapFit {
    // From (clip x, clip y, 1) of light space to the map in texels, x right and y down; w unused.
    x: vec4<f32>,
    y: vec4<f32>,
    // Edge of the map, texels.
    size: f32,
    // Texels per unit of clip space, sizes alone: the larger of |x.x| + |x.y| and |y.x| + |y.y|.
    scale: f32,
    // The same with |x.z| and |y.z|.
    reach: f32,
}

var<uniform> map_fit: MapFit;

// x and y in texels; z is the map's depth, which grows away from the light.
fn light_texel(position: vec3<f32>) -> vec3<f32> {
    return texel_of_clip(light_clip(position));
}

fn texel_of_clip(clip: vec3<f32>) -> vec3<f32> {
    let across = vec3(clip.xy, 1.0);
    return vec3(dot(map_fit.x.xyz, across), dot(map_fit.y.xyz, across), clip.z);
}

// The way back, for drawing.
fn texel_clip(texel: vec2<f32>, depth: f32) -> vec4<f32> {
    let across = texel / map_fit.size * 2.0 - 1.0;
    return vec4(across.x, -across.y, depth, 1.0);
}

fn is_outside(texel: vec2<f32>) -> bool {
    return !(all(texel >= vec2(0.0)) && all(texel < vec2(map_fit.size)));
}

// What rounding may move a receiver and the corners of its casters by, together, in texels and in
// depth: on the way to clip space, and from there on, 4 half ulps of all that is summed up. The map
// may have been rounded itself; it is one for all.
fn light_texel_error_bound(receiver: vec3<f32>) -> vec2<f32> {
    let summed = light_clip_summands(receiver);
    let across = map_fit.scale * summed.x + map_fit.reach;
    return CLIP_ROUNDING * vec2(across, summed.y + 2.0);
}
