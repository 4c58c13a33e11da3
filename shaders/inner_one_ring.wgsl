// Stage to draw the inner conservative depth with the one-ring: every caster on the texels that it
// covers together with the triangles around it (the dissertation's section 4.5 asks for it). From
// the triangle at the texel's centre it walks over every edge that overlaps the texel; no boundary,
// fold or triangle outside the one-ring may turn up, and exactly one triangle of the patch may
// contain the centre. Then the patch covers the texel, and its farthest point there is the depth.

#import "shared/light_edges.wgsl"
#import "shared/casters.wgsl"

struct Params {
    cull: u32,
    depth: u32,
    n: f32,
    small: u32,
}

var<uniform> params: Params;

@vertex
fn vertex(@builtin(vertex_index) index: u32) -> Vertex {
    return inner_vertex(index, params.n, params.small);
}

// Triangles of a patch; a texel that needs more is not covered.
const MOST_MEMBERS: u32 = 16u;
const NOT_COVERED: f32 = -1.0;

@fragment
fn fragment(vertex: Vertex) -> @builtin(frag_depth) f32 {
    let depth = patch_depth(vertex);
    if depth < 0.0 {
        discard;
    }
    return depth;
}

fn patch_depth(vertex: Vertex) -> f32 {
    let centre = vertex.clip.xy;
    let first = vertex.tags.x & PRIMITIVE;
    var triangle = caster_triangle(vertex);
    var depth = texel_depth(triangle, centre, params.depth, FARTHEST);
    var overlaps = vec3(
        edge_overlaps_texel(vertex.a.xy, vertex.b.xy, centre),
        edge_overlaps_texel(vertex.b.xy, vertex.c.xy, centre),
        edge_overlaps_texel(vertex.c.xy, vertex.a.xy, centre),
    );
    // The commonest answers first, for which nothing need be read: the texel overlaps no edge, or
    // one beyond which nothing goes on.
    if !any(overlaps) {
        return depth;
    }
    if any(overlaps & (vertex.tags < vec3(KEPT))) {
        return NOT_COVERED;
    }

    var members: array<u32, MOST_MEMBERS>;
    members[0] = first;
    var count = 1u;
    for (var side = 0u; side < 3u; side++) {
        if overlaps[side] {
            members[count] = scene_adjacency[3u * first + side] / 3u;
            count += 1u;
        }
    }
    var containing = select(0u, 1u, contains(first, triangle, centre));
    for (var member = 1u; member < count; member++) {
        let primitive = members[member];
        triangle = light_triangle(primitive);
        if params.depth != DEPTH_PLANE {
            depth = max(depth, texel_depth(triangle, centre, params.depth, FARTHEST));
        }
        containing += select(0u, 1u, contains(primitive, triangle, centre));
        let corners = array(triangle.a.xy, triangle.b.xy, triangle.c.xy);
        for (var side = 0u; side < 3u; side++) {
            let p = corners[side];
            let q = corners[(side + 1u) % 3u];
            if !edge_overlaps_texel(p, q, centre) {
                continue;
            }
            let own = corners[(side + 2u) % 3u];
            let edge = 3u * primitive + side;
            let beyond = adjacent_triangle(edge, p, q, own, params.cull);
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
            if count == MOST_MEMBERS || !share_corner(first, beyond) {
                return NOT_COVERED;
            }
            members[count] = beyond;
            count += 1u;
        }
    }
    return select(NOT_COVERED, depth, containing == 1u);
}

// Whether two triangles have a corner in common.
fn share_corner(first: u32, second: u32) -> bool {
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

// Whether the triangle contains the point; of two triangles on opposite sides of an edge that the
// point lies on, one does.
fn contains(primitive: u32, triangle: LightTriangle, point: vec2<f32>) -> bool {
    let a = scene_indices[3u * primitive];
    let b = scene_indices[3u * primitive + 1u];
    let c = scene_indices[3u * primitive + 2u];
    let left = left_of(a, b, triangle.a.xy, triangle.b.xy, point);
    return left == left_of(b, c, triangle.b.xy, triangle.c.xy, point)
        && left == left_of(c, a, triangle.c.xy, triangle.a.xy, point);
}
