// Stage to draw the scene's depth as the light sees it, by vertex pulling (three vertices per
// primitive). Texels that a mask leaves out cast no shadow. Williams, "Casting Curved Shadows on
// Curved Surfaces", SIGGRAPH 1978.

#import "shared/map_caster.wgsl"
#import "shared/all_cast.wgsl"

struct Params {
    cull: u32,
    two_sided_bias: f32,
}

var<uniform> params: Params;

struct MaskedVertex {
    @builtin(position) clip: vec4<f32>,
    @location(0) @interpolate(flat) primitive: u32,
    // Weights of the second and the third corner.
    @location(1) weights: vec2<f32>,
}

@vertex
fn vertex(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> {
    let texel = light_texel(corner_position(caster_corner(index)));
    return texel_clip(texel.xy, texel.z);
}

@vertex
fn vertex_masked(@builtin(vertex_index) index: u32) -> MaskedVertex {
    let corner = caster_corner(index);
    let primitive = corner / 3u;
    let texel = light_texel(corner_position(corner));
    var depth = texel.z;
    if is_sheet(primitive) {
        // Its lit face is in the map: away from the light, lest it shade itself.
        let plane = depth_plane(light_triangle(primitive));
        depth += params.two_sided_bias * length(plane.slope);
    }
    let clip = texel_clip(texel.xy, depth);
    let own = corner % 3u;
    return MaskedVertex(clip, primitive, vec2(f32(own == 1u), f32(own == 2u)));
}

@fragment
fn fragment_masked(vertex: MaskedVertex, @builtin(front_facing) is_front: bool) {
    if !is_cast(vertex.primitive, vertex.weights, is_front, params.cull) {
        discard;
    }
}
