// Stage to draw the scene's depth as the light sees it into a projective map: over a trapezoid, or
// of a spot light, or a face of a point light's. Depths are those of light space all the same, as
// each fragment has them, because a plane's are not linear across such a map. Three vertices per
// primitive, pulled. Martin, Tan 2004, section 4; Williams 1978.

#import "shared/map_caster.wgsl"
#import "shared/all_cast.wgsl"

struct Params {
    cull: u32,
    two_sided_bias: f32,
}

var<uniform> params: Params;

// Face of a point light's map.
override face: u32 = 0u;

struct Vertex {
    @builtin(position) clip: vec4<f32>,
    @location(0) depth: f32,
}

struct MaskedVertex {
    @builtin(position) clip: vec4<f32>,
    @location(0) depth: f32,
    @location(1) @interpolate(flat) primitive: u32,
    // Weights of the second and the third corner.
    @location(2) weights: vec2<f32>,
}

@vertex
fn vertex(@builtin(vertex_index) index: u32) -> Vertex {
    return projected(caster_corner(index));
}

@vertex
fn vertex_masked(@builtin(vertex_index) index: u32) -> MaskedVertex {
    let corner = caster_corner(index);
    let place = projected(corner);
    let own = corner % 3u;
    let weights = vec2(f32(own == 1u), f32(own == 2u));
    return MaskedVertex(place.clip, place.depth, corner / 3u, weights);
}

fn projected(corner: u32) -> Vertex {
    let seen = light_homogeneous(corner_position(corner), face);
    let across = vec3(seen.xy, seen.w);
    let w = dot(map_fit.w.xyz, across);
    let texel = vec2(dot(map_fit.x.xyz, across), dot(map_fit.y.xyz, across));
    let place = texel / map_fit.size * 2.0 - w;
    // Clipped where w is 0, so that what is on both sides of the light keeps its part before it.
    return Vertex(vec4(place.x, -place.y, 0.5 * w, w), seen.z);
}

@fragment
fn fragment(vertex: Vertex) -> @builtin(frag_depth) f32 {
    return reached_depth(vertex.depth);
}

// Texels that a mask leaves out cast no shadow; the lit face of a sheet, which is in the map, is
// put away from the light, lest it shade itself.
@fragment
fn fragment_masked(
    vertex: MaskedVertex,
    @builtin(front_facing) is_front: bool,
) -> @builtin(frag_depth) f32 {
    let rise = length(vec2(dpdx(vertex.depth), dpdy(vertex.depth)));
    if !is_cast(vertex.primitive, vertex.weights, is_front, params.cull) {
        discard;
    }
    let bias = select(0.0, params.two_sided_bias * rise, is_sheet(vertex.primitive));
    return min(reached_depth(vertex.depth) + bias, 1.0);
}

// Surfaces that no shadow ray reaches are no casters, 1 as where there is none: a triangle that a
// lamp lies in is seen edge-on, and may cover any texel.
fn reached_depth(depth: f32) -> f32 {
    let is_reached = light_kind == LIGHT_DIRECTIONAL || depth > LIGHT_GAP;
    return select(1.0, saturate(depth), is_reached);
}
