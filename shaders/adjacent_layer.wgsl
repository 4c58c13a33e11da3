// Stage to draw every caster shrunk by `n` texel diagonals at the edges beyond which its surface ends for the light, and whole at the others, whose
// common corners are cut because a triangle that meets the corner alone is unknown (SGSM with adjacency: the dissertation's chapter 4).
// Its four cases, 0 to 3 kept edges, are half planes: d >= s at an edge that shrinks, d + d' >= s at a corner between two that do not.
// Vertex pulling, three vertices per primitive; what is kept lies in the triangle, whose fragments cut it to size.

#import "shared/light_triangle.wgsl"
#import "shared/light_edges.wgsl"

struct Params {
    map_size: u32,
    cull: u32,
    n: f32,
    depth: u32,
}

var<uniform> params: Params;

struct Vertex {
    @builtin(position) clip: vec4<f32>,
    @location(0) @interpolate(flat) a: vec3<f32>,
    @location(1) @interpolate(flat) b: vec3<f32>,
    @location(2) @interpolate(flat) c: vec3<f32>,
    // 1 for an edge that is kept, 0 for one that shrinks: ab, bc, ca.
    @location(3) @interpolate(flat) kept: vec3<f32>,
}

@vertex
fn vertex(@builtin(vertex_index) index: u32) -> Vertex {
    let map_size = f32(params.map_size);
    let first = index - index % 3u;
    let triangle = light_triangle(index / 3u, map_size);
    var vertex = Vertex(vec4(0.0), triangle.a, triangle.b, triangle.c, vec3(0.0));
    if casts(triangle, params.cull) {
        let corners = array(triangle.a.xy, triangle.b.xy, triangle.c.xy);
        vertex.clip = texel_clip(corners[index % 3u], map_size);
        let beyond = vec3(
            across(triangle, first, corners[0], corners[1], params.cull, map_size),
            across(triangle, first + 1u, corners[1], corners[2], params.cull, map_size),
            across(triangle, first + 2u, corners[2], corners[0], params.cull, map_size),
        );
        vertex.kept = select(vec3(1.0), vec3(0.0), beyond == vec3(NO_NEIGHBOUR));
    }
    return vertex;
}

@fragment
fn fragment(vertex: Vertex) -> @builtin(frag_depth) f32 {
    let centre = vertex.clip.xy;
    let area = cross_2d(vertex.b.xy - vertex.a.xy, vertex.c.xy - vertex.a.xy);
    let triangle = LightTriangle(vertex.a, vertex.b, vertex.c, area);
    let cell = params.n * 1.4142136;
    let distances = inward_distances(triangle, centre);
    let kept = vertex.kept > vec3(0.0);
    // Corner b lies between ab and bc, c between bc and ca, a between ca and ab.
    let shrunk_away = !kept & (distances < vec3(cell));
    let cut = kept & kept.yzx & (distances + distances.yzx < vec3(cell));
    if any(shrunk_away) || any(cut) {
        discard;
    }
    return texel_depth(triangle, centre, params.depth, FARTHEST);
}
