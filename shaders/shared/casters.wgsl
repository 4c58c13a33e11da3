// Triangles of the scene that select_casters.wgsl keeps: three corners for each in the map, in
// texels, to be pulled by vertex index.

#import "shared/light_triangle.wgsl"

struct CasterCorner {
    texel: vec3<f32>,
    // The triangle's primitive, KEPT if the edge from this corner to the next is no edge of the
    // surface, and LARGE if `large_casters` has the triangle.
    tag: u32,
}

const KEPT: u32 = 0x80000000u;
const LARGE: u32 = 0x40000000u;
// No binding holds the indices of so many.
const PRIMITIVE: u32 = 0x3fffffffu;

var<storage, read> casters: array<CasterCorner>;

struct Vertex {
    @builtin(position) clip: vec4<f32>,
    @location(0) @interpolate(flat) a: vec3<f32>,
    @location(1) @interpolate(flat) b: vec3<f32>,
    @location(2) @interpolate(flat) c: vec3<f32>,
    @location(3) @interpolate(flat) tags: vec3<u32>,
}

// All three corners of a triangle that is not drawn.
const NOWHERE: vec4<f32> = vec4(0.0);

// Word of the param `small`.
const SMALL_LEAVE_OUT: u32 = 1u;

fn caster_vertex(index: u32) -> Vertex {
    let first = index - index % 3u;
    let a = casters[first];
    let b = casters[first + 1u];
    let c = casters[first + 2u];
    let clip = texel_clip(casters[index].texel.xy, MIDDLE);
    return Vertex(clip, a.texel, b.texel, c.texel, vec3(a.tag, b.tag, c.tag));
}

// The same for the inner map: a triangle is nowhere if `small` leaves it out.
fn inner_vertex(index: u32, n: f32, small: u32) -> Vertex {
    var vertex = caster_vertex(index);
    if small == SMALL_LEAVE_OUT && is_small(vertex, n * 1.4142136) {
        vertex.clip = NOWHERE;
    }
    return vertex;
}

// Returns true if the triangle, its edges moved inward by so many texels, turns inside out or has
// an edge shorter than twice that.
fn is_small(vertex: Vertex, inward: f32) -> bool {
    let ab = distance(vertex.a.xy, vertex.b.xy);
    let bc = distance(vertex.b.xy, vertex.c.xy);
    let ca = distance(vertex.c.xy, vertex.a.xy);
    let twice_area = abs(cross_2d(vertex.b.xy - vertex.a.xy, vertex.c.xy - vertex.a.xy));
    // It shrinks towards the centre of the circle in it, whose radius is twice_area / perimeter.
    let scale = 1.0 - inward * (ab + bc + ca) / max(twice_area, 1e-30);
    return min(ab, min(bc, ca)) * scale < 2.0 * inward;
}

fn caster_triangle(vertex: Vertex) -> LightTriangle {
    let area = cross_2d(vertex.b.xy - vertex.a.xy, vertex.c.xy - vertex.a.xy);
    return LightTriangle(vertex.a, vertex.b, vertex.c, area);
}
