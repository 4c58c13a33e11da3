// Stage to draw the outer conservative depth: every caster grown by `n` texel diagonals, so that it
// covers each texel that it overlaps. Receivers in front of it are lit (BGSM). Vertex pulling,
// three vertices per primitive: a triangle around the grown one, which the fragments cut to size.
// Hasselgren, Akenine-Moller, Ohlsson, "Conservative Rasterization", GPU Gems 2, 2005, second
// algorithm.

#import "shared/light_triangle.wgsl"
#import "shared/all_cast.wgsl"

struct Params {
    cull: u32,
    n: f32,
    depth: u32,
    box: u32,
}

// Word of the param `box`.
const BOX_BY_N: u32 = 1u;

var<uniform> params: Params;

struct Vertex {
    @builtin(position) clip: vec4<f32>,
    @location(0) @interpolate(flat) a: vec3<f32>,
    @location(1) @interpolate(flat) b: vec3<f32>,
    @location(2) @interpolate(flat) c: vec3<f32>,
    @location(3) @interpolate(flat) primitive: u32,
}

@vertex
fn vertex(@builtin(vertex_index) index: u32) -> Vertex {
    let primitive = caster_primitive(index / 3u);
    let triangle = light_triangle(primitive);
    var vertex = Vertex(vec4(0.0), triangle.a, triangle.b, triangle.c, primitive);
    // Others are outer_unplaced.wgsl's.
    if is_placed(triangle) && casts(primitive, triangle, params.cull) {
        vertex.clip = texel_clip(cover(triangle, index % 3u), MIDDLE);
    }
    return vertex;
}

// A corner of a triangle around the grown one: a hair more than fits, for what the rasteriser may
// snap.
fn cover(triangle: LightTriangle, corner: u32) -> vec2<f32> {
    let margin = max(params.n * 1.4142136, 0.70710678) + 0.0625;
    let ab = triangle.b.xy - triangle.a.xy;
    let bc = triangle.c.xy - triangle.b.xy;
    let ca = triangle.a.xy - triangle.c.xy;
    let outside = select(-1.0, 1.0, triangle.area < 0.0);
    // Outward unit normals of the edges; normalising an edge without length gives NaN, which fails
    // the comparison below.
    let n_ab = outside * vec2(-ab.y, ab.x) * inverseSqrt(dot(ab, ab));
    let n_bc = outside * vec2(-bc.y, bc.x) * inverseSqrt(dot(bc, bc));
    let n_ca = outside * vec2(-ca.y, ca.x) * inverseSqrt(dot(ca, ca));
    let bluntness = 1.0 + vec3(dot(n_ca, n_ab), dot(n_ab, n_bc), dot(n_bc, n_ca));
    if min(bluntness.x, min(bluntness.y, bluntness.z)) > 0.1 {
        // The corner where the moved edges meet.
        switch corner {
            case 0u: { return triangle.a.xy + margin * (n_ca + n_ab) / bluntness.x; }
            case 1u: { return triangle.b.xy + margin * (n_ab + n_bc) / bluntness.y; }
            default: { return triangle.c.xy + margin * (n_bc + n_ca) / bluntness.z; }
        }
    }
    // A needle's moved edges meet far away: half of a rectangle twice as large as the one along its
    // longest edge.
    var along = ab;
    if dot(bc, bc) > dot(along, along) { along = bc; }
    if dot(ca, ca) > dot(along, along) { along = ca; }
    let length_squared = dot(along, along);
    along = select(vec2(1.0, 0.0), along * inverseSqrt(length_squared), length_squared > 0.0);
    let aside = vec2(-along.y, along.x);
    let u = vec3(0.0, dot(along, ab), -dot(along, ca));
    let v = vec3(0.0, dot(aside, ab), -dot(aside, ca));
    let low = vec2(min(u.x, min(u.y, u.z)), min(v.x, min(v.y, v.z))) - margin;
    let high = vec2(max(u.x, max(u.y, u.z)), max(v.x, max(v.y, v.z))) + margin;
    var place = low;
    if corner == 1u { place.x += 2.0 * (high.x - low.x); }
    if corner == 2u { place.y += 2.0 * (high.y - low.y); }
    return triangle.a.xy + place.x * along + place.y * aside;
}

struct Texel {
    @builtin(frag_depth) depth: f32,
}

@fragment
fn fragment(vertex: Vertex) -> Texel {
    return Texel(nearest(vertex));
}

fn nearest(vertex: Vertex) -> f32 {
    let centre = vertex.clip.xy;
    let ab = vertex.b.xy - vertex.a.xy;
    let area = cross_2d(ab, vertex.c.xy - vertex.a.xy);
    let triangle = LightTriangle(vertex.a, vertex.b, vertex.c, area);
    let around = select(0.5 + SLACK, params.n * 1.4142136, params.box == BOX_BY_N);
    let low = min(triangle.a.xy, min(triangle.b.xy, triangle.c.xy)) - around;
    let high = max(triangle.a.xy, max(triangle.b.xy, triangle.c.xy)) + around;
    let outward = -min_of(inward_distances(triangle, centre));
    if any(centre < low) || any(centre > high) || outward > params.n * 1.4142136 {
        discard;
    }
    return texel_depth(triangle, centre, params.depth, NEAREST);
}

fn min_of(v: vec3<f32>) -> f32 {
    return min(v.x, min(v.y, v.z));
}
