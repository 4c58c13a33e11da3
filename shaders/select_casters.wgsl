// Stage to bring the triangles that are in the map to light space, once for all three corners, and
// to compact them for an indirect draw; one thread per corner, which answers for the edge that
// begins there, 64 triangles per workgroup.

#import "shared/light_triangle.wgsl"
#import "shared/light_edges.wgsl"
#import "shared/casters.wgsl"

struct Params {
    cull: u32,
    // The corners from this one on, as many as `selected` takes; a multiple of 3.
    first: u32,
}

var<uniform> params: Params;
var<storage, read_write> selected: array<CasterCorner>;
// Vertices, instances, first vertex, first instance.
var<storage, read_write> draw_call: array<atomic<u32>, 4>;

const CORNERS: u32 = 192u;

var<workgroup> texels: array<vec3<f32>, CORNERS>;
// One bit per triangle that is in the map, and the place of the group's first.
var<workgroup> taken: array<atomic<u32>, 2>;
var<workgroup> group_first: u32;

struct Thread {
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
}

// For layers that need no adjacency.
@compute @workgroup_size(CORNERS)
fn alone(thread: Thread) {
    let corner = corner_of(thread);
    let triangle = gather(corner, thread.lane);
    place(corner, thread.lane, triangle, false);
}

@compute @workgroup_size(CORNERS)
fn with_neighbours(thread: Thread) {
    let corner = corner_of(thread);
    let triangle = gather(corner, thread.lane);
    var kept = false;
    if is_asked(corner) && casts(triangle, params.cull) {
        let first = thread.lane - thread.lane % 3u;
        let next = texels[first + (thread.lane + 1u) % 3u].xy;
        let own = texels[first + (thread.lane + 2u) % 3u].xy;
        let here = texels[thread.lane].xy;
        kept = adjacent_triangle(corner, here, next, own, params.cull) != NO_NEIGHBOUR;
    }
    place(corner, thread.lane, triangle, kept);
}

fn corner_of(thread: Thread) -> u32 {
    let index = (thread.group.y * thread.groups.x + thread.group.x) * CORNERS + thread.lane;
    return params.first + index;
}

fn is_asked(corner: u32) -> bool {
    return corner < arrayLength(&scene_indices) && corner - params.first < arrayLength(&selected);
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

fn place(corner: u32, lane: u32, triangle: LightTriangle, kept: bool) {
    // What has no place in the map covers no texel for sure.
    let in_map = is_asked(corner) && is_placed(triangle) && casts(triangle, params.cull);
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
    if in_map {
        let in_low = countOneBits(low & (bit - 1u));
        let in_high = countOneBits(low) + countOneBits(high & (bit - 1u));
        let before = select(in_low, in_high, word == 1u);
        let tag = corner / 3u | select(0u, KEPT, kept);
        selected[group_first + 3u * before + lane % 3u] = CasterCorner(texels[lane], tag);
    }
}
