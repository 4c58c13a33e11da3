// Stage to draw the outer conservative depth of triangles that have no place in a spot light's map,
// each over a rectangle around what of the map it may cover, at the depth of its nearest corner.
// Those that may cover all of it are one. Three vertices per triangle of find_unplaced.wgsl.

#import "shared/face_triangle.wgsl"
#import "shared/ids.wgsl"
#import "shared/unplaced.wgsl"

struct Params {
    cull: u32,
}

var<uniform> params: Params;

var<storage, read> unplaced: array<u32>;
var<storage, read> unplaced_nearest: u32;

struct Vertex {
    @builtin(position) clip: vec4<f32>,
    // Fields of a FaceTriangle; `volume` is 0 in the one over all of the map.
    @location(0) @interpolate(flat) a: vec3<f32>,
    @location(1) @interpolate(flat) b: vec3<f32>,
    @location(2) @interpolate(flat) c: vec3<f32>,
    @location(3) @interpolate(flat) summed: vec3<f32>,
    @location(4) @interpolate(flat) volume: f32,
    @location(5) @interpolate(flat) nearest: f32,
}

@vertex
fn vertex(@builtin(vertex_index) index: u32) -> Vertex {
    let primitive = unplaced[index / 3u];
    let none = vec3(0.0);
    var vertex = Vertex(vec4(0.0), none, none, none, none, 0.0, 0.0);
    if primitive == NO_PRIMITIVE {
        if unplaced_nearest != 0u {
            vertex.nearest = depth_of_nearness(unplaced_nearest);
            let corner = corner_around(whole_map(), vec2(1.0, 0.0), index % 3u);
            vertex.clip = texel_clip(corner, MIDDLE);
        }
        return vertex;
    }
    let triangle = face_triangle(primitive);
    vertex.a = triangle.corners[0];
    vertex.b = triangle.corners[1];
    vertex.c = triangle.corners[2];
    vertex.summed = triangle.summed;
    vertex.volume = triangle.volume;
    vertex.nearest = saturate(triangle.nearest);
    if casts(primitive, LightTriangle(none, none, none, triangle.volume), params.cull) {
        let part = part_of_map(triangle);
        if part.count > 0u {
            let corner = corner_around(part, narrowest(part, triangle), index % 3u);
            vertex.clip = texel_clip(corner, MIDDLE);
        }
    }
    return vertex;
}

// Corners of a convex part of the map, in texels: its own four, and one more for each side of a
// triangle that cuts it.
const MOST_CORNERS: u32 = 7u;

struct Part {
    corners: array<vec2<f32>, MOST_CORNERS>,
    count: u32,
}

fn whole_map() -> Part {
    var part: Part;
    let size = map_fit.size;
    part.corners[0] = vec2(0.0, 0.0);
    part.corners[1] = vec2(size, 0.0);
    part.corners[2] = vec2(size, size);
    part.corners[3] = vec2(0.0, size);
    part.count = 4u;
    return part;
}

// All texels' centres that `may_cover` has, and what rounding adds: the three planes through the
// light and an edge are straight lines in the map, which cut it one after the other (Sutherland,
// Hodgman, "Reentrant Polygon Clipping", CACM 17(1), 1974).
fn part_of_map(triangle: FaceTriangle) -> Part {
    var part = whole_map();
    var corners = triangle.corners;
    var summed = triangle.summed;
    for (var i = 0u; i < 3u; i++) {
        let j = (i + 1u) % 3u;
        let p = corners[i];
        let q = corners[j];
        // As in `may_cover`, in the place's powers, which rounds more.
        let across = p.z * q.xy - q.z * p.xy;
        let error = 200.0 * CLIP_ROUNDING * summed[i] * summed[j];
        let leeway = (0.5 + SLACK) * (abs(across.x) + abs(across.y)) + error;
        let line = sign(triangle.volume) * vec3(-across.y, across.x, cross_2d(p.xy, q.xy));
        let before = part;
        part.count = 0u;
        for (var k = 0u; k < before.count; k++) {
            let here = before.corners[k];
            let next = before.corners[(k + 1u) % before.count];
            let inside_here = dot(line, vec3(here, 1.0)) + leeway;
            let inside_next = dot(line, vec3(next, 1.0)) + leeway;
            if inside_here >= 0.0 {
                add(&part, here);
            }
            if (inside_here >= 0.0) != (inside_next >= 0.0) {
                add(&part, mix(here, next, inside_here / (inside_here - inside_next)));
            }
        }
    }
    return part;
}

// A convex part has room for all; rounding may make it less than convex.
fn add(part: ptr<function, Part>, corner: vec2<f32>) {
    if (*part).count < MOST_CORNERS {
        (*part).corners[(*part).count] = corner;
        (*part).count += 1u;
    }
}

// The direction, of the triangle's edges in the map and of the map's own, along which a rectangle
// around the part is smallest.
fn narrowest(part: Part, triangle: FaceTriangle) -> vec2<f32> {
    var corners = triangle.corners;
    var best = vec2(1.0, 0.0);
    var least = area_around(part, best);
    for (var i = 0u; i < 3u; i++) {
        let p = corners[i];
        let q = corners[(i + 1u) % 3u];
        let along = p.z * q.xy - q.z * p.xy;
        let size = length(along);
        let area = area_around(part, along / size);
        // An edge of no length has no direction.
        if size > 0.0 && area < least {
            least = area;
            best = along / size;
        }
    }
    return best;
}

fn area_around(part: Part, along: vec2<f32>) -> f32 {
    let bounds = bounds_along(part, along);
    return (bounds.z - bounds.x) * (bounds.w - bounds.y);
}

// Least and greatest along a direction and across it.
fn bounds_along(part: Part, along: vec2<f32>) -> vec4<f32> {
    var corners = part.corners;
    var low = vec2(3e38);
    var high = vec2(-3e38);
    for (var i = 0u; i < part.count; i++) {
        let place = vec2(dot(along, corners[i]), cross_2d(along, corners[i]));
        low = min(low, place);
        high = max(high, place);
    }
    return vec4(low, high);
}

// Returns a corner of a triangle around the rectangle, twice as large.
fn corner_around(part: Part, along: vec2<f32>, corner: u32) -> vec2<f32> {
    let bounds = bounds_along(part, along) + vec4(-1.0, -1.0, 1.0, 1.0);
    var place = bounds.xy;
    if corner == 1u { place.x += 2.0 * (bounds.z - bounds.x); }
    if corner == 2u { place.y += 2.0 * (bounds.w - bounds.y); }
    return place.x * along + place.y * vec2(-along.y, along.x);
}

@fragment
fn fragment(vertex: Vertex) -> @builtin(frag_depth) f32 {
    let corners = array(vertex.a, vertex.b, vertex.c);
    let triangle = FaceTriangle(corners, vertex.summed, vertex.volume, vertex.nearest, false);
    if !may_cover(triangle, vertex.clip.xy) {
        discard;
    }
    return vertex.nearest;
}
