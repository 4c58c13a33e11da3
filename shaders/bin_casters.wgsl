// Stage to append each caster to the lists of the texels that it overlaps and in which some
// receiver is not nearer to the light. `bin_small`: one thread per triangle, which leaves those
// over many tiles to `bin_large`: one workgroup per part of a large one, whose threads take its
// tiles in turns. So no thread looks at more than 2,048 texels, however large a triangle is.

#import "shared/camera.wgsl"
#import "shared/groups.wgsl"
#import "shared/light_buffer.wgsl"
#import "shared/face_triangle.wgsl"

struct Params {
    longest_list: u32,
}

struct BinnedTexel {
    max_receiver_depth: atomic<u32>,
    length: atomic<u32>,
    head: atomic<u32>,
    full_coverage_depth: atomic<u32>,
}

struct Large {
    // Those included for which there is no room.
    count: atomic<u32>,
    parts: array<Part>,
}

var<uniform> params: Params;
// As mark_tiles.wgsl has them.
var<storage, read> tiles: array<vec4<u32>>;
// Of the grid; behind them one that says LIST_LACKS if a part of a large triangle had no room.
var<storage, read_write> texels: array<BinnedTexel>;
// Those included for which there is no room.
var<storage, read_write> entry_count: atomic<u32>;
// As `Texel` has it.
var<storage, read_write> entries: array<vec4<u32>>;
var<storage, read_write> large: Large;
// Workgroups in x, y, z: one for each part.
var<storage, read_write> large_groups: array<atomic<u32>, 3>;

// Tiles under the box of a triangle that one thread does alone.
const ALONE: u32 = 32u;
// Tiles of a part.
const PART: u32 = 2048u;

// Whether a caster is there wherever its triangle is, and depths are those of the light's space: no
// mask, a directional light.
override has_covers: bool = false;

struct Binned {
    primitive: u32,
    // Its corners are counter-clockwise where y is up: inside is to the left of its edges.
    triangle: LightTriangle,
    plane: DepthPlane,
    // The first and the last of the map's texels under its box, in each direction.
    first: vec2<u32>,
    last: vec2<u32>,
    // How far the centre of a texel that the triangle overlaps may be beyond the lines of ab, bc
    // and ca, times their lengths.
    edge_threshold: vec3<f32>,
    // What a texel is taken larger by on each side: SLACK, and more in fine grids and near a light.
    dilation: f32,
    // What the tracer may find it nearer to the light by, or farther from it, in depth.
    depth_tolerance: f32,
}

struct Thread {
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
}

@compute @workgroup_size(GROUP_SIZE)
fn bin_small(thread: Thread) {
    let primitive = (thread.group.y * thread.groups.x + thread.group.x) * GROUP_SIZE + thread.lane;
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
    bin(caster, 0u, count, 1u);
}

@compute @workgroup_size(GROUP_SIZE)
fn bin_large(thread: Thread) {
    let number = group_number(thread.group);
    if number >= min(atomicLoad(&large.count), arrayLength(&large.parts)) {
        return;
    }
    let part = large.parts[number];
    let caster = caster_of(part.primitive);
    let tiles = tiles_of(caster);
    let end = min(tiles.x * tiles.y, part.first_tile + PART);
    bin(caster, part.first_tile + thread.lane, end, GROUP_SIZE);
}

fn append_part(part: Part) {
    let slot = atomicAdd(&large.count, 1u);
    if slot >= arrayLength(&large.parts) {
        atomicStore(&texels[arrayLength(&texels) - 1u].length, LIST_LACKS);
        return;
    }
    large.parts[slot] = part;
    atomicMax(&large_groups[0], min(slot + 1u, GROUPS_PER_ROW));
    atomicMax(&large_groups[1], slot / GROUPS_PER_ROW + 1u);
    atomicMax(&large_groups[2], 1u);
}

fn caster_of(primitive: u32) -> Binned {
    if light_kind != LIGHT_DIRECTIONAL {
        return caster_of_face(primitive);
    }
    let triangle = light_triangle(primitive);
    var plane = depth_plane(triangle);
    let edge_tolerance = edge_tolerance();
    let dilation = max(SLACK, edge_tolerance);
    plane.margin *= dilation / SLACK;
    var depth_tolerance = TRACED * light.max_distance / light.extent.z;
    if plane.margin >= 0.0 {
        depth_tolerance += (edge_tolerance + weights_error(triangle)) * max_depth_slope();
    }
    return caster_over(primitive, triangle, plane, dilation, depth_tolerance);
}

// What the tracer's view of a triangle may differ from its corners by, in any direction, as a share
// of the longest way, twice the diagonal of the scene's box: docs/light_buffer.md.
const TRACED: f32 = 16.0 * HALF_ULP;

// How far a receiver may be beyond an edge, in texels in each direction, and the tracer not tell.
// Of a directional light.
fn edge_tolerance() -> f32 {
    let placed = texel_error_of_summands(map_fit, light_clip_summands_of_scene()).x;
    let clip = light.max_distance / min(light.extent.x, light.extent.y);
    return placed + TRACED * map_fit.scale * clip;
}

// How far apart, in texels, what the tracer's weights say and where it hits may be: an area errs by
// 4 half ulps of the longest edge's square, and three of them are summed up.
fn weights_error(triangle: LightTriangle) -> f32 {
    let ab = triangle.b.xy - triangle.a.xy;
    let bc = triangle.c.xy - triangle.b.xy;
    let ca = triangle.a.xy - triangle.c.xy;
    let longest = sqrt(max(dot(ab, ab), max(dot(bc, bc), dot(ca, ca))));
    return 12.0 * HALF_ULP * longest * longest * longest / abs(triangle.area);
}

// Depth that the way along the longest axis of the light's direction changes by in a texel's width:
// by up to sqrt(2) times that, whatever the triangle's slope.
fn max_depth_slope() -> f32 {
    let texels = vec2(length(map_fit.x.xy), length(map_fit.y.xy));
    let widest = max(light.extent.x, light.extent.y) / min(texels.x, texels.y);
    let narrowest = min(light.extent.x, light.extent.y) / max(texels.x, texels.y);
    return 1.5 * widest * (widest / narrowest) / light.extent.z;
}

fn caster_over(
    primitive: u32,
    projected: LightTriangle,
    plane: DepthPlane,
    dilation: f32,
    depth_tolerance: f32,
) -> Binned {
    var triangle = projected;
    if triangle.area < 0.0 {
        triangle = LightTriangle(triangle.a, triangle.c, triangle.b, -triangle.area);
    }
    let a = triangle.a;
    let b = triangle.b;
    let c = triangle.c;
    let low = floor(min(a.xy, min(b.xy, c.xy)) - dilation);
    let high = floor(max(a.xy, max(b.xy, c.xy)) + dilation);
    let end = map_fit.size - 1.0;
    let is_beside = any(high < vec2(0.0)) || any(low > vec2(end));
    let first = select(vec2<u32>(max(low, vec2(0.0))), vec2(1u), is_beside);
    let last = select(vec2<u32>(min(high, vec2(end))), vec2(0u), is_beside);
    let edge_threshold = vec3(
        edge_threshold_of(b.xy - a.xy, dilation),
        edge_threshold_of(c.xy - b.xy, dilation),
        edge_threshold_of(a.xy - c.xy, dilation),
    );
    return Binned(
        primitive, triangle, plane, first, last, edge_threshold, dilation, depth_tolerance,
    );
}

// In a face of a spot or point light's map: where the corners are projected to, if all are before
// the light; depths are those of the corners, since a plane's are not linear there.
fn caster_of_face(primitive: u32) -> Binned {
    let a = light_homogeneous(corner_position(3u * primitive), binned_layer);
    let b = light_homogeneous(corner_position(3u * primitive + 1u), binned_layer);
    let c = light_homogeneous(corner_position(3u * primitive + 2u), binned_layer);
    let least = saturate(min(a.z, min(b.z, c.z)));
    let greatest = saturate(max(a.z, max(b.z, c.z)));
    let nearest = min(a.w, min(b.w, c.w));
    // What projection makes of rounding, and of what the tracer's view may differ by, seen from the
    // nearest corner.
    let projected_ratio = max(
        max_projected_ratio(a),
        max(max_projected_ratio(b), max_projected_ratio(c)),
    );
    let spread = light_spread();
    let rounding = TRACED * light.max_distance * (1.0 + spread) / nearest
        + CLIP_ROUNDING * (2.0 + 4.0 * spread) * (1.0 + projected_ratio) * (1.0 + projected_ratio);
    let dilation = SLACK + map_fit.scale * rounding;
    let depth_tolerance = TRACED * light.max_distance / light.range;
    if !(nearest > 0.0 && dilation < 0.125 * map_fit.size) {
        let plane = DepthPlane(vec3(0.0), vec2(0.0), -1.0, least, greatest, 0.0);
        return caster_of_whole_face(primitive, a, b, c, plane, depth_tolerance);
    }
    let p = face_texel(a);
    let q = face_texel(b);
    let r = face_texel(c);
    let triangle = LightTriangle(p, q, r, cross_2d(q.xy - p.xy, r.xy - p.xy));
    let plane = DepthPlane(p, vec2(0.0), -1.0, least, greatest, 0.0);
    return caster_over(primitive, triangle, plane, dilation, depth_tolerance);
}

fn face_texel(seen: vec4<f32>) -> vec3<f32> {
    let across = vec3(seen.xy / seen.w, 1.0);
    return vec3(dot(map_fit.x.xyz, across), dot(map_fit.y.xyz, across), seen.z);
}

fn max_projected_ratio(seen: vec4<f32>) -> f32 {
    return max(abs(seen.x), abs(seen.y)) / seen.w;
}

// A triangle that reaches behind the light, or nearly to it, has no corners to speak of: it may be
// anywhere in the face, unless it is beside it as a whole.
fn caster_of_whole_face(
    primitive: u32,
    a: vec4<f32>,
    b: vec4<f32>,
    c: vec4<f32>,
    plane: DepthPlane,
    depth_tolerance: f32,
) -> Binned {
    let beside = is_beside(a, b, c);
    let first = select(vec2(0u), vec2(1u), beside);
    let last = select(vec2(u32(map_fit.size) - 1u), vec2(0u), beside);
    let nowhere = LightTriangle(vec3(0.0), vec3(0.0), vec3(0.0), 0.0);
    return Binned(primitive, nowhere, plane, first, last, vec3(1e30), SLACK, depth_tolerance);
}

fn edge_threshold_of(edge: vec2<f32>, dilation: f32) -> f32 {
    return (0.5 + dilation) * (abs(edge.x) + abs(edge.y));
}

// Columns and rows of tiles under its box.
fn tiles_of(caster: Binned) -> vec2<u32> {
    return caster.last / TILE - caster.first / TILE + 1u;
}

// Appends the caster to the lists of the texels in those tiles under its box whose numbers are
// `first`, `first + step`, … below `end`. Threads run in step, and some adapters run what any of
// them could need: so each looks for its next tile, then for the texels in it, in short loops.
fn bin(caster: Binned, first: u32, end: u32, step: u32) {
    let columns = tiles_of(caster).x;
    let corner = caster.first / TILE;
    var tile = corner + vec2(first % columns, first / columns);
    // A division in every round would cost more than all else.
    let advance = vec2(step % columns, step / columns);
    var number = first;
    loop {
        var inside = vec2(0u);
        var at = tile;
        while all(inside == vec2(0u)) && number < end {
            at = tile;
            inside = texels_in(caster, tile);
            number += step;
            tile += advance;
            tile = select(tile, vec2(tile.x - columns, tile.y + 1u), tile.x >= corner.x + columns);
        }
        if all(inside == vec2(0u)) {
            return;
        }
        // All texels of the tile first, as threads differ in which of them they are in.
        var listed = vec2(0u);
        loop {
            let bit = first_bit(inside);
            if is_listed(caster, at * TILE + first_of(inside)) {
                listed |= bit;
            }
            inside &= ~bit;
            if all(inside == vec2(0u)) {
                break;
            }
        }
        if all(listed == vec2(0u)) {
            continue;
        }
        let lines = lines_of(caster);
        let entries_here = countOneBits(listed.x) + countOneBits(listed.y);
        var slot = atomicAdd(&entry_count, entries_here);
        while any(listed != vec2(0u)) {
            append(caster, at * TILE + first_of(listed), slot, lines);
            listed &= ~first_bit(listed);
            slot += 1u;
        }
    }
}

// Whether a texel's list gets the caster; counts it.
fn is_listed(caster: Binned, texel: vec2<u32>) -> bool {
    let number = texel_number(binned_layer, texel);
    let centre = vec2<f32>(texel) + 0.5;
    let inward = edge_functions(caster.triangle, centre);
    let max_receiver_depth = atomicLoad(&texels[number].max_receiver_depth);
    let may_shade = depth_bits(least_depth(caster, centre)) <= max_receiver_depth;
    if !(all(inward >= -caster.edge_threshold) && may_shade) {
        return false;
    }
    // The texel, larger by 4 times the slack on every side, is inside of what covers it.
    let enlarged = (1.0 + 6.0 * caster.dilation) * caster.edge_threshold;
    let covers = caster.plane.margin >= 0.0 && all(inward >= enlarged);
    if has_covers && covers {
        let depth = covered_depth(caster, centre);
        atomicMax(&texels[number].full_coverage_depth, ~depth_bits(depth));
        // Nobody behind it asks a list.
        atomicMin(&texels[number].max_receiver_depth, depth_bits(depth + cover_margin()));
    }
    // Nobody reads a list that is longer.
    return (atomicAdd(&texels[number].length, 1u) & ~LIST_LACKS) < params.longest_list;
}

// Whoever is farther from the light, in a texel that the caster covers, has all of its triangle
// before it, wherever rounding may have either, and the tracer finds it; and none of its own
// receivers is.
fn covered_depth(caster: Binned, centre: vec2<f32>) -> f32 {
    let plane = caster.plane;
    let slope = abs(plane.slope);
    let farthest = plane_depth(plane, centre) + (0.5 + 4.0 * plane.margin) * (slope.x + slope.y);
    let rounding = 4.0 * caster.depth_tolerance + farthest_receiver_error() / light.extent.z;
    return saturate(clamp(farthest, plane.least, plane.greatest) + rounding);
}

// `receiver_error_bound` of any in the scene, whose corners are as far from the eye as may be.
fn farthest_receiver_error() -> f32 {
    let centre = light.centre.xyz;
    let ways = length(centre) + 2.0 * length(centre - camera.eye) + 3.0 * light.max_distance;
    return HALF_ULP * ways;
}

// How much deeper than a cover a receiver may be that test_casters.wgsl does not find behind it:
// its rounding and twice its `receiver_error_bound`, and what adding that up errs by.
fn cover_margin() -> f32 {
    let placed = texel_error_of_summands(map_fit, light_clip_summands_of_scene()).y;
    return 2.02 * (placed + farthest_receiver_error() / light.extent.z) + 4.0 * HALF_ULP;
}

// In a texel.
fn least_depth(caster: Binned, centre: vec2<f32>) -> f32 {
    return max(depth_bound(caster.plane, centre, 0.5, NEAREST) - caster.depth_tolerance, 0.0);
}

// A bit for each texel of the tile that is under the triangle's box and has a receiver in it; none
// if the triangle is not in the tile, or farther from the light than all its receivers.
fn texels_in(caster: Binned, tile: vec2<u32>) -> vec2<u32> {
    let marked = tiles[tile_number(binned_layer, tile)];
    let middle = (vec2<f32>(tile) + 0.5) * f32(TILE);
    let nearest = depth_bound(caster.plane, middle, 0.5 * f32(TILE), NEAREST);
    let depth = nearest - caster.depth_tolerance;
    let may_shade = depth_bits(depth) <= marked.x
        && all(edge_functions(caster.triangle, middle) >= -f32(TILE) * caster.edge_threshold);
    let low = max(caster.first, tile * TILE) - tile * TILE;
    let high = min(caster.last - tile * TILE, vec2(TILE - 1u));
    let columns = (0xffu << low.x) & (0xffu >> (TILE - 1u - high.x));
    let rows = (0xffu << low.y) & (0xffu >> (TILE - 1u - high.y));
    let bits = vec2(bytes_of(rows & 0xfu), bytes_of(rows >> 4u)) * columns;
    return select(vec2(0u), bits & marked.yz, may_shade);
}

// 1 in each byte whose bit is set in a number of four bits.
fn bytes_of(bits: u32) -> u32 {
    return (bits * 0x204081u) & 0x1010101u;
}

// Distances of a point from the lines of ab, bc and ca, times their lengths; inside is positive.
fn edge_functions(triangle: LightTriangle, point: vec2<f32>) -> vec3<f32> {
    return vec3(
        cross_2d(triangle.b.xy - triangle.a.xy, point - triangle.a.xy),
        cross_2d(triangle.c.xy - triangle.b.xy, point - triangle.b.xy),
        cross_2d(triangle.a.xy - triangle.c.xy, point - triangle.c.xy),
    );
}

fn append(caster: Binned, texel: vec2<u32>, slot: u32, lines: Lines) {
    let number = texel_number(binned_layer, texel);
    if slot >= arrayLength(&entries) {
        atomicOr(&texels[number].length, LIST_LACKS);
        return;
    }
    let centre = vec2<f32>(texel) + 0.5;
    let inward = edge_functions(caster.triangle, centre);
    let distances = inward * lines.per_length + lines.dilation;
    let ab = Edge(lines.inward.x, distances.x);
    let bc = Edge(lines.inward.y, distances.y);
    let ca = Edge(lines.inward.z, distances.z);
    // The one that cuts the least area off the texel is left out: about the part of the edge that
    // is near it, times how far the texel reaches beyond.
    let cut = (caster.edge_threshold - inward) * lines.per_near;
    var one = ab;
    var other = ca;
    if cut.x <= min(cut.y, cut.z) {
        one = bc;
    } else if cut.z < cut.y {
        other = bc;
    }
    let key = entry_key(least_depth(caster, centre), one, other);
    let next = atomicExchange(&texels[number].head, slot + 1u);
    entries[slot] = vec4(next, caster.primitive, key);
}

// What keys say of a triangle's edges ab, bc and ca that is the same in all texels.
struct Lines {
    // As `Edge` has it.
    inward: vec3<u32>,
    // 1 / the longer component of each; 0 of one without length, which is no line.
    per_length: vec3<f32>,
    // Distances that lines are moved outward by.
    dilation: vec3<f32>,
    // 1 / the length of the part of each that is near a texel, about.
    per_near: vec3<f32>,
}

fn lines_of(caster: Binned) -> Lines {
    let triangle = caster.triangle;
    let edges = array(
        triangle.b.xy - triangle.a.xy,
        triangle.c.xy - triangle.b.xy,
        triangle.a.xy - triangle.c.xy,
    );
    var beyond = caster.dilation + SLACK;
    if light_kind == LIGHT_DIRECTIONAL {
        beyond = edge_tolerance();
    }
    var lines: Lines;
    for (var i = 0u; i < 3u; i++) {
        let size = abs(edges[i]);
        let longest = max(size.x, size.y);
        let is_line = longest >= 1e-30;
        let per_length = select(0.0, 1.0 / longest, is_line);
        lines.inward[i] = inward_bytes(vec2(-edges[i].y, edges[i].x) * per_length);
        lines.per_length[i] = per_length;
        lines.dilation[i] = select(1.0, beyond * (size.x + size.y) * per_length, is_line);
    }
    lines.per_near = 1.0 / max(2.0 * caster.edge_threshold, vec3(1.0));
    return lines;
}
