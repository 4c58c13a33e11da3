// Stage to draw the outer conservative depth by the rasteriser, where it counts each texel that a
// caster overlaps (`conservative: true`): no shader grows the caster. Hasselgren, Akenine-Moller,
// Ohlsson, "Conservative Rasterization", GPU Gems 2, 2005.

#import "shared/casters.wgsl"

struct Params {
    depth: u32,
}

var<uniform> params: Params;

@vertex
fn vertex(@builtin(vertex_index) index: u32) -> Vertex {
    return caster_vertex(index);
}

@fragment
fn fragment(vertex: Vertex) -> @builtin(frag_depth) f32 {
    return texel_depth(caster_triangle(vertex), vertex.clip.xy, params.depth, NEAREST);
}
