// Where a square shadow map lies across light space: any affine map of it will do, the same for
// receivers and casters; where nothing is proven of the map, a projective one, too. Made by
// shared/fit_map.ron.

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
    extent: f32,
    // Farthest distance from the eye, along its direction, among the receivers that ask this layer.
    end: f32,
    // Divisor of x and y in a projective map; 0, 0, 1 in an affine one.
    w: vec4<f32>,
}

// Maps in layers lie in one buffer, each where a device can bind it alone: every 256 bytes. (Where
// naga writes GLSL or WGSL it passes over `@size`.)
struct MapFitSlot {
    fit: MapFit,
    rest: array<vec4<f32>, 12>,
}

var<uniform> map_fit: MapFit;

// Nothing divides unless the graph says so.
override map_is_projective: bool = false;

// Share of the way to a split's end before which some receivers go over to the next one.
override split_blend: f32 = 0.0;

// x and y in texels; z is the map's depth, which grows away from the light.
fn light_texel(position: vec3<f32>) -> vec3<f32> {
    return texel_of(map_fit, position);
}

fn texel_of(fit: MapFit, position: vec3<f32>) -> vec3<f32> {
    return texel_of_clip(fit, light_clip(position));
}

fn texel_of_clip(fit: MapFit, clip: vec3<f32>) -> vec3<f32> {
    let across = vec3(clip.xy, 1.0);
    let texel = vec2(dot(fit.x.xyz, across), dot(fit.y.xyz, across));
    if map_is_projective {
        let w = dot(fit.w.xyz, across);
        // A place behind the map's centre of projection is nowhere in it.
        return vec3(select(vec2(-1.0), texel / w, w > 0.0), clip.z);
    }
    return vec3(texel, clip.z);
}

// The way back, for drawing.
fn texel_clip(texel: vec2<f32>, depth: f32) -> vec4<f32> {
    let across = texel / map_fit.size * 2.0 - 1.0;
    return vec4(across.x, -across.y, depth, 1.0);
}

fn is_outside(texel: vec2<f32>) -> bool {
    return is_outside_of(map_fit, texel);
}

fn is_outside_of(fit: MapFit, texel: vec2<f32>) -> bool {
    return !(all(texel >= vec2(0.0)) && all(texel < vec2(fit.size)));
}

// Returns all that is summed up for x, y or w of a point in the cone of a spot light's map, sizes
// alone, per unit of w. A point light's faces take one coordinate each.
fn light_spread() -> f32 {
    if light_kind == LIGHT_POINT {
        return 1.0;
    }
    let matrix = transpose(light.clip_from_relative);
    let most = max(abs(matrix[0].xyz), max(abs(matrix[1].xyz), abs(matrix[3].xyz)));
    return (most.x + most.y + most.z) / max(light.edge_cosine, 1e-3);
}

// Bounds the rounding of a point before a spot light, in texels: 5 half ulps of all that is summed
// up for x, y and w, a division of 2.5 ulp, and then 4 half ulps.
fn spot_texel_error(fit: MapFit, position: vec3<f32>) -> f32 {
    let way = abs(light_way(position));
    let seen = light_homogeneous(position, 0u);
    let matrix = transpose(light.clip_from_relative);
    let across = max(dot(abs(matrix[0].xyz), way), dot(abs(matrix[1].xyz), way)) / seen.w;
    let along = dot(abs(matrix[3].xyz), way) / seen.w;
    let projected_ratio = max(abs(seen.x), abs(seen.y)) / seen.w;
    let clip = 1.5 * (across + projected_ratio * (along + 1.0)) + projected_ratio;
    return CLIP_ROUNDING * (fit.scale * clip + fit.extent);
}

// Bounds the rounding of a receiver and the corners of its casters together, in texels and in
// depth: on the way to clip space, and from there on, 4 half ulps of all that is summed up. The map
// may have been rounded itself; it is one for all. For affine maps.
fn texel_error_bound_of(fit: MapFit, receiver: vec3<f32>) -> vec2<f32> {
    return texel_error_of_summands(fit, light_clip_summands(receiver));
}

// `summed`: of `light_clip_summands`; not asked for under a spot or point light.
fn texel_error_of_summands(fit: MapFit, summed: vec2<f32>) -> vec2<f32> {
    if light_kind != LIGHT_DIRECTIONAL {
        // Bound of the receiver alone, where |x| and |y| are at most w: its casters differ in
        // theirs.
        let across = fit.scale * (2.0 + 4.0 * light_spread()) + fit.extent;
        return CLIP_ROUNDING * vec2(across, 2.0 + 2.0 * light.max_distance / light.range);
    }
    let across = fit.scale * summed.x + fit.extent;
    return CLIP_ROUNDING * vec2(across, summed.y + 2.0);
}
