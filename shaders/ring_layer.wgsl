// Stage to draw every caster on the texels that it covers together with the triangles around it (SGSM with the whole one-ring; the
// dissertation's section 4.5 asks for it). From the triangle at the texel's centre it walks over every edge that meets the texel; no boundary, fold or
// triangle outside the one-ring may turn up, and exactly one triangle of the patch may contain the centre. Then the patch covers the texel,
// and its farthest point there is the depth. Vertex pulling, three vertices per primitive.

#import "shared/light_triangle.wgsl"
#import "shared/light_edges.wgsl"

struct Params {
    map_size: u32,
    cull: u32,
    depth: u32,
}

var<uniform> params: Params;

struct Vertex {
    @builtin(position) clip: vec4<f32>,
    @location(0) @interpolate(flat) primitive: u32,
}

@vertex
fn vertex(@builtin(vertex_index) index: u32) -> Vertex {
    let primitive = index / 3u;
    let map_size = f32(params.map_size);
    let triangle = light_triangle(primitive, map_size);
    var vertex = Vertex(vec4(0.0), primitive);
    if casts(triangle, params.cull) {
        let corners = array(triangle.a.xy, triangle.b.xy, triangle.c.xy);
        vertex.clip = texel_clip(corners[index % 3u], map_size);
    }
    return vertex;
}

@fragment
fn fragment(vertex: Vertex) -> @builtin(frag_depth) f32 {
    let depth = patch_depth(vertex.primitive, vertex.clip.xy);
    if depth < 0.0 {
        discard;
    }
    return depth;
}

// Triangles of a patch; a texel that needs more is not covered.
const MOST_MEMBERS: u32 = 16u;
const NOT_COVERED: f32 = -1.0;

fn patch_depth(first: u32, centre: vec2<f32>) -> f32 {
    let map_size = f32(params.map_size);
    var members: array<u32, MOST_MEMBERS>;
    members[0] = first;
    var count = 1u;
    var containing = 0u;
    var depth = 0.0;
    for (var member = 0u; member < count; member++) {
        let primitive = members[member];
        let triangle = light_triangle(primitive, map_size);
        if member == 0u || params.depth != DEPTH_PLANE {
            depth = max(depth, texel_depth(triangle, centre, params.depth, FARTHEST));
        }
        containing += select(0u, 1u, contains(primitive, triangle, centre));
        let corners = array(triangle.a.xy, triangle.b.xy, triangle.c.xy);
        for (var side = 0u; side < 3u; side++) {
            let p = corners[side];
            let q = corners[(side + 1u) % 3u];
            if !meets(p, q, centre) {
                continue;
            }
            let beyond = across(triangle, 3u * primitive + side, p, q, params.cull, map_size);
            if beyond == NO_NEIGHBOUR {
                return NOT_COVERED;
            }
            var known = false;
            for (var other = 0u; other < count; other++) {
                known = known || members[other] == beyond;
            }
            if known {
                continue;
            }
            if count == MOST_MEMBERS || !touch(first, beyond) {
                return NOT_COVERED;
            }
            members[count] = beyond;
            count += 1u;
        }
    }
    return select(NOT_COVERED, depth, containing == 1u);
}

// Whether an edge meets the texel; errs towards yes. Separating axes of a segment and a square.
fn meets(p: vec2<f32>, q: vec2<f32>, centre: vec2<f32>) -> bool {
    let half = 0.5 + SLACK;
    if any(min(p, q) > centre + half) || any(max(p, q) < centre - half) {
        return false;
    }
    let edge = q - p;
    return abs(cross_2d(edge, centre - p)) <= half * (abs(edge.x) + abs(edge.y));
}

// Whether two triangles have a corner in common.
fn touch(first: u32, second: u32) -> bool {
    for (var corner = 0u; corner < 3u; corner++) {
        let index = scene_indices[3u * first + corner];
        for (var other = 0u; other < 3u; other++) {
            if index == scene_indices[3u * second + other] {
                return true;
            }
        }
    }
    return false;
}

// Whether the triangle contains the point; of two triangles on opposite sides of an edge that the point lies on, one does.
fn contains(primitive: u32, triangle: LightTriangle, point: vec2<f32>) -> bool {
    let a = scene_indices[3u * primitive];
    let b = scene_indices[3u * primitive + 1u];
    let c = scene_indices[3u * primitive + 2u];
    let left = left_of(a, b, triangle.a.xy, triangle.b.xy, point);
    return left == left_of(b, c, triangle.b.xy, triangle.c.xy, point) && left == left_of(c, a, triangle.c.xy, triangle.a.xy, point);
}

// Evaluated from the lower index to the higher one, so that both triangles of an edge see the same sign.
fn left_of(tail: u32, head: u32, p: vec2<f32>, q: vec2<f32>, point: vec2<f32>) -> bool {
    let swap = head < tail;
    let low = select(p, q, swap);
    let high = select(q, p, swap);
    return (cross_2d(high - low, point - low) >= 0.0) != swap;
}
