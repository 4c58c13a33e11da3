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

// The large ones among `casters`, by their number there. Walks are dear, and few of their texels
// need one: `large` and `without_walk` draw the others, `edge` the texels at the ends of edges.
var<storage, read> large_casters: array<u32>;

// Small ones, all of whose texels walk.
@vertex
fn vertex(@builtin(vertex_index) index: u32) -> Vertex {
    var vertex = inner_vertex(index, params.n, params.small);
    if (vertex.tags.x & LARGE) != 0u {
        vertex.clip = NOWHERE;
    }
    return vertex;
}

struct Large {
    @builtin(position) clip: vec4<f32>,
    @location(0) @interpolate(flat) a: vec3<f32>,
    @location(1) @interpolate(flat) b: vec3<f32>,
    @location(2) @interpolate(flat) c: vec3<f32>,
    @location(3) @interpolate(flat) tags: vec3<u32>,
    // The third corners of the triangles beyond kept edges.
    @location(4) @interpolate(flat) beyond_ab: vec3<f32>,
    @location(5) @interpolate(flat) beyond_bc: vec3<f32>,
    @location(6) @interpolate(flat) beyond_ca: vec3<f32>,
}

@vertex
fn large(@builtin(vertex_index) index: u32) -> Large {
    let first = 3u * large_casters[index / 3u];
    let vertex = inner_vertex(first + index % 3u, params.n, params.small);
    return Large(
        vertex.clip,
        vertex.a,
        vertex.b,
        vertex.c,
        vertex.tags,
        corner_beyond(vertex.tags.x, 0u),
        corner_beyond(vertex.tags.y, 1u),
        corner_beyond(vertex.tags.z, 2u),
    );
}

// Returns the corner beyond a kept edge.
fn corner_beyond(tag: u32, edge: u32) -> vec3<f32> {
    if tag < KEPT {
        return vec3(0.0);
    }
    return light_texel(corner_position(scene_adjacency[3u * (tag & PRIMITIVE) + edge]));
}

// Texels that overlap no edge, or one alone, beyond which a triangle covers the rest.
@fragment
fn without_walk(vertex: Large) -> @builtin(frag_depth) f32 {
    let centre = vertex.clip.xy;
    let caster = Vertex(vertex.clip, vertex.a, vertex.b, vertex.c, vertex.tags);
    let overlaps = overlapped(caster);
    var depth = texel_depth(caster_triangle(caster), centre, params.depth, FARTHEST);
    if any(overlaps) {
        let one = (overlaps.x != overlaps.y) != overlaps.z && !all(overlaps);
        let tags = vertex.tags;
        let tag = select(select(tags.z, tags.y, overlaps.y), tags.x, overlaps.x);
        let p = select(select(vertex.c, vertex.b, overlaps.y), vertex.a, overlaps.x);
        let q = select(select(vertex.a, vertex.c, overlaps.y), vertex.b, overlaps.x);
        let third = select(
            select(vertex.beyond_ca, vertex.beyond_bc, overlaps.y),
            vertex.beyond_ab,
            overlaps.x,
        );
        let ends = edge_overlaps_texel(q.xy, third.xy, centre)
            || edge_overlaps_texel(third.xy, p.xy, centre);
        if !one || tag < KEPT || ends {
            discard;
        }
        if params.depth != DEPTH_PLANE {
            let area = cross_2d(p.xy - q.xy, third.xy - q.xy);
            let beyond = LightTriangle(q, p, third, area);
            depth = max(depth, texel_depth(beyond, centre, params.depth, FARTHEST));
        }
    }
    return depth;
}

// Greatest distance, in texels, from an edge to the centre of a texel that it overlaps: half the
// diagonal of one that is larger by SLACK on every side, and a hair for the rasteriser.
const REACH: f32 = 0.71815 + 0.0625;
const HAIR: f32 = 0.0625;
const EDGE_VERTICES: u32 = 12u;

// A rectangle at either end of an edge, around the texels that may overlap another one there; one
// along all of it where they meet.
@vertex
fn edge(@builtin(vertex_index) index: u32) -> Vertex {
    let first = 3u * large_casters[index / (3u * EDGE_VERTICES)];
    let edge = index / EDGE_VERTICES % 3u;
    var vertex = inner_vertex(first, params.n, params.small);
    let is_second = index % EDGE_VERTICES >= EDGE_VERTICES / 2u;
    let from_here = casters[first + edge];
    let p = from_here.texel.xy;
    let q = casters[first + (edge + 1u) % 3u].texel.xy;
    let apex = casters[first + (edge + 2u) % 3u].texel.xy;
    let edge_length = distance(p, q);
    // No texel that overlaps an edge beyond which nothing goes on is covered; those of a masked
    // triangle have no length.
    if all(vertex.clip == NOWHERE) || from_here.tag < KEPT || edge_length == 0.0 {
        vertex.clip = NOWHERE;
        return vertex;
    }
    let third = corner_beyond(from_here.tag, edge).xy;
    let along = (q - p) / edge_length;
    let inward = select(1.0, -1.0, cross_2d(along, apex - p) < 0.0) * vec2(-along.y, along.x);
    let at_p = max(end_reach(along, apex - p), end_reach(along, third - p));
    let at_q = max(end_reach(-along, apex - q), end_reach(-along, third - q));
    var low = -REACH;
    var high = edge_length + REACH;
    if at_p + at_q < edge_length {
        low = select(low, edge_length - at_q, is_second);
        high = select(at_p, high, is_second);
    } else if is_second {
        vertex.clip = NOWHERE;
        return vertex;
    }
    // Two triangles.
    let corner = index % 6u;
    let x = select(low, high, corner == 1u || corner == 2u || corner == 4u);
    let y = select(-HAIR, REACH, corner == 2u || corner >= 4u);
    vertex.clip = texel_clip(p + x * along + y * inward, MIDDLE);
    return vertex;
}

// How far along an edge from its end a texel that it overlaps can overlap the edge to `other`, too:
// strips around lines at an angle t meet up to cot(t / 2) of their half width away.
fn end_reach(along: vec2<f32>, other: vec2<f32>) -> f32 {
    let cotangent = (length(other) + dot(along, other)) / abs(cross_2d(along, other));
    return REACH * max(1.0, cotangent);
}

@fragment
fn fragment(vertex: Vertex) -> @builtin(frag_depth) f32 {
    let depth = patch_depth(vertex);
    if depth < 0.0 {
        discard;
    }
    return depth;
}

// Triangles of a patch; a texel that needs more is not covered.
const MOST_MEMBERS: u32 = 16u;
const NOT_COVERED: f32 = -1.0;

fn patch_depth(vertex: Vertex) -> f32 {
    let centre = vertex.clip.xy;
    let first = vertex.tags.x & PRIMITIVE;
    var triangle = caster_triangle(vertex);
    var depth = texel_depth(triangle, centre, params.depth, FARTHEST);
    let overlaps = overlapped(vertex);
    // The commonest answers first, for which nothing need be read: the texel overlaps no edge, or
    // one beyond which nothing goes on.
    let is_large = (vertex.tags.x & LARGE) != 0u;
    if !any(overlaps) {
        return select(depth, NOT_COVERED, is_large);
    }
    // The drawn shape of a large one reaches beyond it.
    if is_large && any(inward_distances(triangle, centre) < vec3(-SLACK)) {
        return NOT_COVERED;
    }
    if any(overlaps & (vertex.tags < vec3(KEPT))) {
        return NOT_COVERED;
    }

    // Each member by its corner opposite the edge over which the walk came to it; the first one by
    // its first corner.
    let ring = corners_of(first);
    var members: array<u32, MOST_MEMBERS>;
    members[0] = 3u * first;
    var count = 1u;
    for (var side = 0u; side < 3u; side++) {
        if overlaps[side] {
            members[count] = scene_adjacency[3u * first + side];
            count += 1u;
        }
    }
    var containing = select(0u, 1u, contains(ring, triangle, centre));
    for (var member = 1u; member < count; member++) {
        let primitive = members[member] / 3u;
        let behind = (members[member] + 1u) % 3u;
        let ids = corners_of(primitive);
        triangle = light_triangle(primitive);
        if params.depth != DEPTH_PLANE {
            depth = max(depth, texel_depth(triangle, centre, params.depth, FARTHEST));
        }
        containing += select(0u, 1u, contains(ids, triangle, centre));
        // Edges to go over. One at a time: most members have none but the one behind.
        var open = vec3(
            edge_overlaps_texel(triangle.a.xy, triangle.b.xy, centre),
            edge_overlaps_texel(triangle.b.xy, triangle.c.xy, centre),
            edge_overlaps_texel(triangle.c.xy, triangle.a.xy, centre),
        ) & (vec3(behind) != vec3(0u, 1u, 2u));
        while any(open) {
            let side = select(select(2u, 1u, open.y), 0u, open.x);
            open &= vec3(side) != vec3(0u, 1u, 2u);
            let p = select(select(triangle.c, triangle.b, side == 1u), triangle.a, side == 0u).xy;
            let q = select(select(triangle.a, triangle.c, side == 1u), triangle.b, side == 0u).xy;
            let own = select(select(triangle.b, triangle.a, side == 1u), triangle.c, side == 0u).xy;
            let beyond = adjacent_corner(3u * primitive + side, p, q, own, params.cull);
            if beyond == NO_NEIGHBOUR {
                return NOT_COVERED;
            }
            var known = false;
            for (var other = 0u; other < count; other++) {
                known = known || members[other] / 3u == beyond / 3u;
            }
            if known {
                continue;
            }
            let next = 3u * primitive + (side + 1u) % 3u;
            let touches = is_corner(scene_indices[3u * primitive + side], ring)
                || is_corner(scene_indices[next], ring)
                || is_corner(scene_indices[beyond], ring);
            if count == MOST_MEMBERS || !touches {
                return NOT_COVERED;
            }
            members[count] = beyond;
            count += 1u;
        }
    }
    return select(NOT_COVERED, depth, containing == 1u);
}

// The edges ab, bc and ca that overlap the texel.
fn overlapped(vertex: Vertex) -> vec3<bool> {
    let centre = vertex.clip.xy;
    return vec3(
        edge_overlaps_texel(vertex.a.xy, vertex.b.xy, centre),
        edge_overlaps_texel(vertex.b.xy, vertex.c.xy, centre),
        edge_overlaps_texel(vertex.c.xy, vertex.a.xy, centre),
    );
}

fn is_corner(id: u32, corners: vec3<u32>) -> bool {
    return any(vec3(id) == corners);
}

fn corners_of(primitive: u32) -> vec3<u32> {
    let first = 3u * primitive;
    return vec3(scene_indices[first], scene_indices[first + 1u], scene_indices[first + 2u]);
}

// Returns true if the triangle contains the point; of two triangles on opposite sides of an edge
// that the point lies on, one does.
fn contains(ids: vec3<u32>, triangle: LightTriangle, point: vec2<f32>) -> bool {
    let left = left_of(ids.x, ids.y, triangle.a.xy, triangle.b.xy, point);
    return left == left_of(ids.y, ids.z, triangle.b.xy, triangle.c.xy, point)
        && left == left_of(ids.z, ids.x, triangle.c.xy, triangle.a.xy, point);
}
