// Stage to draw every caster shrunk by `n` texel diagonals, so that it covers only texels that lie in it as a whole: the layer behind
// which everything is in shadow (SGSM of Hertel, Hormann, Westermann, "A Hybrid GPU Rendering Pipeline for Alias-Free Hard Shadows",
// Eurographics 2009). Vertex pulling, three vertices per primitive; what shrinks lies in the triangle, whose fragments cut it to size.

#import "shared/light_triangle.wgsl"

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
}

@vertex
fn vertex(@builtin(vertex_index) index: u32) -> Vertex {
    let map_size = f32(params.map_size);
    let triangle = light_triangle(index / 3u, map_size);
    var vertex = Vertex(vec4(0.0), triangle.a, triangle.b, triangle.c);
    if casts(triangle, params.cull) {
        let corners = array(triangle.a.xy, triangle.b.xy, triangle.c.xy);
        vertex.clip = texel_clip(corners[index % 3u], map_size);
    }
    return vertex;
}

@fragment
fn fragment(vertex: Vertex) -> @builtin(frag_depth) f32 {
    let centre = vertex.clip.xy;
    let area = cross_2d(vertex.b.xy - vertex.a.xy, vertex.c.xy - vertex.a.xy);
    let triangle = LightTriangle(vertex.a, vertex.b, vertex.c, area);
    // One that is shrunk away or turned inside out has no such point.
    if any(inward_distances(triangle, centre) < vec3(params.n * 1.4142136)) {
        discard;
    }
    return texel_depth(triangle, centre, params.depth, FARTHEST);
}
