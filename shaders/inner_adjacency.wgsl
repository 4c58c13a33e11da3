// Stage to draw the inner conservative depth with adjacency: every caster shrunk by `n` texel
// diagonals at the edges beyond which its surface ends for the light, and whole at the others.
// Their common corners are cut, because a triangle that meets the corner alone is unknown (SGSM
// with adjacency: the dissertation's chapter 4). Its four cases, 0 to 3 kept edges, are half
// planes: d >= s at an edge that shrinks, d + d' >= c at a corner between two that do not. A corner
// in a texel may be half a diagonal from its centre, and each of the two edges as far, so c is a
// diagonal at least; the dissertation's is s. The part that is kept lies in the triangle, whose
// fragments cut it to size.

#import "shared/casters.wgsl"

struct Params {
    n: f32,
    depth: u32,
    small: u32,
    corners: u32,
}

// Word of the param `corners`.
const CORNERS_BY_N: u32 = 1u;

var<uniform> params: Params;

@vertex
fn vertex(@builtin(vertex_index) index: u32) -> Vertex {
    return inner_vertex(index, params.n, params.small);
}

@fragment
fn fragment(vertex: Vertex) -> @builtin(frag_depth) f32 {
    let centre = vertex.clip.xy;
    let triangle = caster_triangle(vertex);
    let cell = params.n * 1.4142136;
    let distances = inward_distances(triangle, centre);
    let kept = vertex.tags >= vec3(KEPT);
    // Corner b lies between ab and bc, c between bc and ca, a between ca and ab.
    let shrunk_away = !kept & (distances < vec3(cell));
    let corner = select(max(cell, 1.4142136), cell, params.corners == CORNERS_BY_N);
    let cut = kept & kept.yzx & (distances + distances.yzx < vec3(corner));
    if any(shrunk_away) || any(cut) {
        discard;
    }
    return texel_depth(triangle, centre, params.depth, FARTHEST);
}
