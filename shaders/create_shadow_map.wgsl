// Stage to draw the scene's depth as the light sees it, by vertex pulling (three vertices per
// primitive). Texels that a mask leaves out cast no shadow. Williams, "Casting Curved Shadows on
// Curved Surfaces", SIGGRAPH 1978.

#import "shared/map_fit.wgsl"
#import "shared/geometry.wgsl"
#import "shared/solid.wgsl"

struct MaskedVertex {
    @builtin(position) clip: vec4<f32>,
    @location(0) @interpolate(flat) primitive: u32,
    // Weights of the second and the third corner.
    @location(1) weights: vec2<f32>,
}

@vertex
fn vertex(@builtin(vertex_index) corner: u32) -> @builtin(position) vec4<f32> {
    let texel = light_texel(corner_position(corner));
    return texel_clip(texel.xy, texel.z);
}

@vertex
fn vertex_masked(@builtin(vertex_index) corner: u32) -> MaskedVertex {
    let texel = light_texel(corner_position(corner));
    let clip = texel_clip(texel.xy, texel.z);
    let own = corner % 3u;
    return MaskedVertex(clip, corner / 3u, vec2(f32(own == 1u), f32(own == 2u)));
}

@fragment
fn fragment_masked(vertex: MaskedVertex) {
    if !is_opaque(vertex.primitive, vertex.weights.x, vertex.weights.y) {
        discard;
    }
}
