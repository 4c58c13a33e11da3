// Stage to draw the inner conservative depth: every caster shrunk by `n` texel diagonals, so that
// it covers only texels that lie in it as a whole. Receivers behind it are in shadow (SGSM of
// Hertel, Hormann, Westermann, "A Hybrid GPU Rendering Pipeline for Alias-Free Hard Shadows",
// Eurographics 2009). A shrunk triangle lies in the original, whose fragments cut it to size.

#import "shared/casters.wgsl"

struct Params {
    n: f32,
    depth: u32,
    small: u32,
}

var<uniform> params: Params;

@vertex
fn vertex(@builtin(vertex_index) index: u32) -> Vertex {
    return inner_vertex(index, params.n, params.small);
}

@fragment
fn fragment(vertex: Vertex) -> @builtin(frag_depth) f32 {
    let centre = vertex.clip.xy;
    let triangle = caster_triangle(vertex);
    // One that is shrunk away or turned inside out has no such point.
    if any(inward_distances(triangle, centre) < vec3(params.n * 1.4142136)) {
        discard;
    }
    return texel_depth(triangle, centre, params.depth, FARTHEST);
}
