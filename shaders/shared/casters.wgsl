// What select_casters.wgsl leaves of the scene: three corners per triangle that is in the map, in
// texels, to be pulled by vertex index.

#import "shared/light_triangle.wgsl"

struct CasterCorner {
    texel: vec3<f32>,
    // The triangle's primitive, and KEPT if the edge from this corner to the next is no edge of the
    // surface.
    tag: u32,
}

const KEPT: u32 = 0x80000000u;
const PRIMITIVE: u32 = 0x7fffffffu;

var<storage, read> casters: array<CasterCorner>;

struct Vertex {
    @builtin(position) clip: vec4<f32>,
    @location(0) @interpolate(flat) a: vec3<f32>,
    @location(1) @interpolate(flat) b: vec3<f32>,
    @location(2) @interpolate(flat) c: vec3<f32>,
    @location(3) @interpolate(flat) tags: vec3<u32>,
}

fn caster_vertex(index: u32, map_size: f32) -> Vertex {
    let first = index - index % 3u;
    let a = casters[first];
    let b = casters[first + 1u];
    let c = casters[first + 2u];
    let clip = texel_clip(casters[index].texel.xy, map_size);
    return Vertex(clip, a.texel, b.texel, c.texel, vec3(a.tag, b.tag, c.tag));
}

fn caster_triangle(vertex: Vertex) -> LightTriangle {
    let area = cross_2d(vertex.b.xy - vertex.a.xy, vertex.c.xy - vertex.a.xy);
    return LightTriangle(vertex.a, vertex.b, vertex.c, area);
}
