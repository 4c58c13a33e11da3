// As create_shadow_map.wgsl, where triangles are masked: what a mask leaves out casts no shadow.

#import "shared/map_fit.wgsl"
#import "shared/geometry.wgsl"
#import "shared/masks.wgsl"

struct Vertex {
    @builtin(position) clip: vec4<f32>,
    @location(0) @interpolate(flat) primitive: u32,
    // Weights of the second and the third corner.
    @location(1) weights: vec2<f32>,
}

@vertex
fn vertex(@builtin(vertex_index) corner: u32) -> Vertex {
    let texel = light_texel(corner_position(corner));
    let clip = texel_clip(texel.xy, texel.z);
    let own = corner % 3u;
    return Vertex(clip, corner / 3u, vec2(f32(own == 1u), f32(own == 2u)));
}

@fragment
fn fragment(vertex: Vertex) {
    if !is_opaque(vertex.primitive, vertex.weights.x, vertex.weights.y) {
        discard;
    }
}
