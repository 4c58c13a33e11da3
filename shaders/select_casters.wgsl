// Stage to bring the triangles that are in the map to light space, once for all three corners, and
// to compact them for an indirect draw; one thread per corner, which answers for the edge that
// begins there, 64 triangles per workgroup.

#import "shared/groups.wgsl"
#import "shared/all_cast.wgsl"
#import "shared/light_triangle.wgsl"
#import "shared/light_edges.wgsl"
#import "shared/casters.wgsl"

struct Params {
    cull: u32,
    // The casters' corners from this one on, as many as `selected` takes; a multiple of 3.
    first: u32,
}

var<uniform> params: Params;
var<storage, read_write> selected: array<CasterCorner>;
// Vertices, instances, first vertex, first instance.
var<storage, read_write> draw_call: array<atomic<u32>, 4>;
// Which triangles of `selected` are large, by their number there, and two such calls to draw them:
// three vertices each, and as many as their edges take.
var<storage, read_write> selected_large: array<u32>;
var<storage, read_write> large_calls: array<array<atomic<u32>, 4>>;

const CORNERS: u32 = 192u;
// Vertices at the edges of a large triangle, see inner_one_ring.wgsl.
const EDGE_VERTICES: u32 = 36u;
const NO_SLOT: u32 = 0xffffffffu;
const NO_CORNER: u32 = 0xffffffffu;
// Least radius of the circle in a large triangle, in texels. Among 2, 4 and 8 the first two drew
// the layer equally fast, the last more slowly.
const LEAST_RADIUS: f32 = 3.0;

var<workgroup> texels: array<vec3<f32>, CORNERS>;
// One bit per triangle that is in the map, and the place of the group's first.
var<workgroup> taken: array<atomic<u32>, 2>;
var<workgroup> group_first: u32;

// For layers that need no adjacency.
@compute @workgroup_size(CORNERS)
fn alone(thread: Thread) {
    let corner = corner_of(thread);
    let triangle = gather(corner, thread.lane);
    place(corner, thread.lane, triangle, 0u);
}

@compute @workgroup_size(CORNERS)
fn with_neighbours(thread: Thread) {
    let corner = corner_of(thread);
    let triangle = gather(corner, thread.lane);
    place(corner, thread.lane, triangle, kept_tag(corner, thread.lane, triangle));
}

// With neighbours, and large ones listed.
@compute @workgroup_size(CORNERS)
fn with_large(thread: Thread) {
    let corner = corner_of(thread);
    let triangle = gather(corner, thread.lane);
    let large = is_large(triangle);
    let tag = kept_tag(corner, thread.lane, triangle) | select(0u, LARGE, large);
    let slot = place(corner, thread.lane, triangle, tag);
    if slot != NO_SLOT && large && slot % 3u == 0u {
        let number = atomicAdd(&large_calls[0][0], 3u) / 3u;
        atomicStore(&large_calls[0][1], 1u);
        atomicAdd(&large_calls[1][0], EDGE_VERTICES);
        atomicStore(&large_calls[1][1], 1u);
        selected_large[number] = slot / 3u;
    }
}

// True if most of its texels are clear of its edges, because the circle in it, whose radius is
// twice the area by the perimeter, is wide.
fn is_large(triangle: LightTriangle) -> bool {
    let perimeter = distance(triangle.a.xy, triangle.b.xy)
        + distance(triangle.b.xy, triangle.c.xy)
        + distance(triangle.c.xy, triangle.a.xy);
    return abs(triangle.area) > LEAST_RADIUS * perimeter;
}

fn kept_tag(corner: u32, lane: u32, triangle: LightTriangle) -> u32 {
    var kept = false;
    if is_asked(corner) && casts(corner / 3u, triangle, params.cull) {
        let first = lane - lane % 3u;
        let next = texels[first + (lane + 1u) % 3u].xy;
        let own = texels[first + (lane + 2u) % 3u].xy;
        let here = texels[lane].xy;
        kept = adjacent_corner(corner, here, next, own, params.cull) != NO_NEIGHBOUR;
    }
    return select(0u, KEPT, kept);
}

fn corner_of(thread: Thread) -> u32 {
    let index = (thread.group.y * thread.groups.x + thread.group.x) * CORNERS + thread.lane;
    if index >= arrayLength(&selected) || params.first + index >= 3u * caster_count() {
        return NO_CORNER;
    }
    return caster_corner(params.first + index);
}

fn is_asked(corner: u32) -> bool {
    return corner != NO_CORNER;
}

fn gather(corner: u32, lane: u32) -> LightTriangle {
    if is_asked(corner) {
        texels[lane] = light_corner(corner);
    }
    workgroupBarrier();
    let first = lane - lane % 3u;
    let a = texels[first];
    let b = texels[first + 1u];
    let c = texels[first + 2u];
    return LightTriangle(a, b, c, cross_2d(b.xy - a.xy, c.xy - a.xy));
}

// Returns where in `selected` the corner is, NO_SLOT if nowhere.
fn place(corner: u32, lane: u32, triangle: LightTriangle, tag: u32) -> u32 {
    // A triangle without a place in the map covers no texel for sure.
    let in_map = is_asked(corner) && is_placed(triangle)
        && casts(corner / 3u, triangle, params.cull);
    let word = lane / 96u;
    let bit = 1u << (lane / 3u % 32u);
    if in_map {
        atomicOr(&taken[word], bit);
    }
    workgroupBarrier();
    let low = atomicLoad(&taken[0]);
    let high = atomicLoad(&taken[1]);
    if lane == 0u {
        group_first = atomicAdd(&draw_call[0], 3u * (countOneBits(low) + countOneBits(high)));
        atomicStore(&draw_call[1], 1u);
    }
    workgroupBarrier();
    if !in_map {
        return NO_SLOT;
    }
    let in_low = countOneBits(low & (bit - 1u));
    let in_high = countOneBits(low) + countOneBits(high & (bit - 1u));
    let before = select(in_low, in_high, word == 1u);
    let slot = group_first + 3u * before + lane % 3u;
    selected[slot] = CasterCorner(texels[lane], (corner / 3u) | tag);
    return slot;
}
