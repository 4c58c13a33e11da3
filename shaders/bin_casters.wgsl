// Stage to append each caster to the lists of the texels that it overlaps and in which some
// receiver is not nearer to the light. `whole`: one thread per triangle, which leaves those over
// many tiles to `parts`: one workgroup per part of a large one, whose threads take its tiles in
// turns. So no thread looks at more than 4,096 texels, however large a triangle is.

#import "shared/light_buffer.wgsl"

struct Params {
    map_size: u32,
    longest_list: u32,
}

struct List {
    // Number of its first entry; LIST_FULL if one had no room.
    head: atomic<u32>,
    // Entries that it should have.
    length: atomic<u32>,
}

struct Large {
    // Those included for which there is no room.
    count: atomic<u32>,
    parts: array<Part>,
}

var<uniform> params: Params;
// As mark_receivers.wgsl has it.
var<storage, read> farthest: array<u32>;
// Of each texel.
var<storage, read_write> lists: array<List>;
// Those included for which there is no room.
var<storage, read_write> entry_count: atomic<u32>;
var<storage, read_write> entries: array<Entry>;
var<storage, read_write> large: Large;
// Workgroups in x, y, z: one for each part.
var<storage, read_write> large_groups: array<atomic<u32>, 3>;

const THREADS: u32 = 64u;
// Tiles under the box of a triangle that one thread does alone.
const ALONE: u32 = 32u;
// Tiles of a part.
const PART: u32 = 4096u;
// Most workgroups in one dimension of a dispatch.
const GROUPS_PER_ROW: u32 = 65535u;

struct Caster {
    primitive: u32,
    // Its corners are counter-clockwise where y is up: inside is to the left of its edges.
    triangle: LightTriangle,
    // The first and the last of the texels under its box, in each direction.
    first: vec2<u32>,
    last: vec2<u32>,
    // Bits of its least depth.
    least: u32,
    // How far the centre of a texel that the triangle overlaps may be beyond the lines of ab, bc
    // and ca, times their lengths.
    reach: vec3<f32>,
}

struct Thread {
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
}

@compute @workgroup_size(THREADS)
fn whole(thread: Thread) {
    let primitive = (thread.group.y * thread.groups.x + thread.group.x) * THREADS + thread.lane;
    if 3u * primitive >= arrayLength(&scene_indices) {
        return;
    }
    let caster = caster_of(primitive);
    if any(caster.last < caster.first) {
        return;
    }
    let tiles = tiles_of(caster);
    let count = tiles.x * tiles.y;
    if count > ALONE {
        for (var first = 0u; first < count; first += PART) {
            append_part(Part(primitive, first));
        }
        return;
    }
    for (var tile = 0u; tile < count; tile++) {
        bin(caster, tile, tiles.x);
    }
}

@compute @workgroup_size(THREADS)
fn parts(thread: Thread) {
    let number = thread.group.y * GROUPS_PER_ROW + thread.group.x;
    if number >= min(atomicLoad(&large.count), arrayLength(&large.parts)) {
        return;
    }
    let part = large.parts[number];
    let caster = caster_of(part.primitive);
    let tiles = tiles_of(caster);
    let end = min(tiles.x * tiles.y, part.first_tile + PART);
    for (var tile = part.first_tile + thread.lane; tile < end; tile += THREADS) {
        bin(caster, tile, tiles.x);
    }
}

fn append_part(part: Part) {
    let slot = atomicAdd(&large.count, 1u);
    if slot >= arrayLength(&large.parts) {
        return;
    }
    large.parts[slot] = part;
    atomicMax(&large_groups[0], min(slot + 1u, GROUPS_PER_ROW));
    atomicMax(&large_groups[1], slot / GROUPS_PER_ROW + 1u);
    atomicMax(&large_groups[2], 1u);
}

fn caster_of(primitive: u32) -> Caster {
    let size = f32(params.map_size);
    var triangle = light_triangle(primitive, size);
    if triangle.area < 0.0 {
        triangle = LightTriangle(triangle.a, triangle.c, triangle.b, -triangle.area);
    }
    let a = triangle.a;
    let b = triangle.b;
    let c = triangle.c;
    let low = min(a.xy, min(b.xy, c.xy)) - SLACK;
    let high = max(a.xy, max(b.xy, c.xy)) + SLACK;
    let is_outside = any(high < vec2(0.0)) || any(low >= vec2(size));
    let first = select(vec2<u32>(max(low, vec2(0.0))), vec2(1u), is_outside);
    let last = select(min(vec2<u32>(high), vec2(params.map_size - 1u)), vec2(0u), is_outside);
    let least = depth_bits(min(a.z, min(b.z, c.z)));
    let reach = vec3(reach_of(b.xy - a.xy), reach_of(c.xy - b.xy), reach_of(a.xy - c.xy));
    return Caster(primitive, triangle, first, last, least, reach);
}

fn reach_of(edge: vec2<f32>) -> f32 {
    return (0.5 + SLACK) * (abs(edge.x) + abs(edge.y));
}

// Columns and rows of tiles under its box.
fn tiles_of(caster: Caster) -> vec2<u32> {
    return caster.last / TILE - caster.first / TILE + 1u;
}

// Appends the caster to the lists of one tile's texels.
fn bin(caster: Caster, number: u32, columns: u32) {
    let tile = caster.first / TILE + vec2(number % columns, number / columns);
    if farthest[tile_number(tile, params.map_size)] < caster.least {
        return;
    }
    let middle = (vec2<f32>(tile) + 0.5) * f32(TILE);
    if any(inward_of(caster.triangle, middle) < -f32(TILE) * caster.reach) {
        return;
    }
    let first = max(caster.first, tile * TILE);
    let last = min(caster.last, tile * TILE + (TILE - 1u));
    for (var y = first.y; y <= last.y; y++) {
        for (var x = first.x; x <= last.x; x++) {
            let texel = y * params.map_size + x;
            let far = farthest[texel];
            if far == 0u || far < caster.least {
                continue;
            }
            let centre = vec2(f32(x), f32(y)) + 0.5;
            let inward = inward_of(caster.triangle, centre);
            if any(inward < -caster.reach) {
                continue;
            }
            let depth = abs(texel_depth(caster.triangle, centre, DEPTH_CONSERVATIVE, NEAREST));
            if depth_bits(depth) <= far {
                append(texel, caster.primitive, key_of(caster, depth, inward));
            }
        }
    }
}

// Distances of a point from the lines of ab, bc and ca, times their lengths; inside is positive.
fn inward_of(triangle: LightTriangle, point: vec2<f32>) -> vec3<f32> {
    return vec3(
        cross_2d(triangle.b.xy - triangle.a.xy, point - triangle.a.xy),
        cross_2d(triangle.c.xy - triangle.b.xy, point - triangle.b.xy),
        cross_2d(triangle.a.xy - triangle.c.xy, point - triangle.c.xy),
    );
}

// Of its edges, the one that cuts most off the texel makes the key.
fn key_of(caster: Caster, depth: f32, inward: vec3<f32>) -> u32 {
    let triangle = caster.triangle;
    // An edge without length is no line.
    let share = select(inward / caster.reach, vec3(3e38), caster.reach == vec3(0.0));
    var edge = triangle.b.xy - triangle.a.xy;
    var distance = inward.x;
    if share.y < share.x && share.y <= share.z {
        edge = triangle.c.xy - triangle.b.xy;
        distance = inward.y;
    } else if share.z < share.x {
        edge = triangle.a.xy - triangle.c.xy;
        distance = inward.z;
    }
    let longest = max(abs(edge.x), abs(edge.y));
    if longest == 0.0 {
        return entry_key(depth, vec2(1.0, 0.0), 1.0);
    }
    return entry_key(depth, vec2(-edge.y, edge.x) / longest, distance / longest);
}

fn append(texel: u32, primitive: u32, key: u32) {
    // Nobody reads a list that is longer.
    if atomicAdd(&lists[texel].length, 1u) >= params.longest_list {
        return;
    }
    let slot = atomicAdd(&entry_count, 1u);
    if slot >= arrayLength(&entries) {
        atomicStore(&lists[texel].head, LIST_FULL);
        return;
    }
    let next = atomicExchange(&lists[texel].head, slot + 1u);
    entries[slot] = Entry(next, key, primitive);
}
