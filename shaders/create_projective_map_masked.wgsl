// As create_projective_map.wgsl, where triangles are masked: what a mask leaves out casts no
// shadow.

#import "create_projective_map.wgsl"
#import "shared/masks.wgsl"

struct MaskedVertex {
    @builtin(position) clip: vec4<f32>,
    @location(0) depth: f32,
    @location(1) @interpolate(flat) primitive: u32,
    // Weights of the second and the third corner.
    @location(2) weights: vec2<f32>,
}

@vertex
fn vertex_masked(@builtin(vertex_index) corner: u32) -> MaskedVertex {
    let place = projected(corner);
    let own = corner % 3u;
    let weights = vec2(f32(own == 1u), f32(own == 2u));
    return MaskedVertex(place.clip, place.depth, corner / 3u, weights);
}

@fragment
fn fragment_masked(vertex: MaskedVertex) -> @builtin(frag_depth) f32 {
    if !is_opaque(vertex.primitive, vertex.weights.x, vertex.weights.y) {
        discard;
    }
    return map_depth(vertex.depth);
}
