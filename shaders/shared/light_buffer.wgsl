// A grid over light space, each texel with the list of the casters that could shade a receiver in
// it. Haines, Greenberg, "The Light Buffer: A Shadow-Testing Accelerator", IEEE CG&A 6(9), 1986.
// Why it is exact: docs/light_buffer_errors.md.

#import "shared/light_triangle.wgsl"
#import "shared/map_layers.wgsl"

// One of the grid's texels. Receivers read it as one vec4.
struct Texel {
    // Bits of the depth of the farthest receiver in it, see `Place`; 0 where there is none. Behind
    // a cover none is looked for.
    max_receiver_depth: u32,
    // Entries that its list should have; and LIST_LACKS if one had no room.
    length: u32,
    // Number of its first entry; LIST_END where there is none.
    head: u32,
    // Bits of a depth, inverted: a receiver farther from the light is in the shadow of a caster
    // that covers all of the texel. 0 where none does.
    full_coverage_depth: u32,
}

// The same while receivers and casters are sought.
struct BinnedTexel {
    max_receiver_depth: atomic<u32>,
    length: atomic<u32>,
    head: atomic<u32>,
    full_coverage_depth: atomic<u32>,
}

const LIST_LACKS: u32 = 0x80000000u;
// An entry is a vec4: the number of the next one, the caster, and whom it cannot shade, see
// `entry_key`. Entries count from 1, so that a cleared buffer holds empty lists.
const LIST_END: u32 = 0u;

// Some of the tiles under the box of a large triangle, from `first_tile` on.
struct Part {
    // Number of its caster.
    caster: u32,
    first_tile: u32,
}

// Edge of a tile, texels. A tile is a vec4: the farthest depth of its texels, a bit for each of
// them that holds a receiver, row by row, and nothing.
const TILE: u32 = 8u;

// The layer of the grid whose lists a pass makes; `map_fit` is its.
override binned_layer: u32 = 0u;

// A bit for each texel of a tile from the first of some to the last, none if that is before it.
fn tile_bits(first: vec2<u32>, last: vec2<u32>, tile: vec2<u32>) -> vec2<u32> {
    let corner = tile * TILE;
    let is_one = all(first < corner + TILE) && all(last >= max(corner, first));
    let low = max(first, corner) - corner;
    let high = min(max(last, corner) - corner, vec2(TILE - 1u));
    let columns = (0xffu << low.x) & (0xffu >> (TILE - 1u - high.x));
    let rows = (0xffu << low.y) & (0xffu >> (TILE - 1u - high.y));
    let bits = vec2(bytes_of(rows & 0xfu), bytes_of(rows >> 4u)) * columns;
    return select(vec2(0u), bits, is_one);
}

// 1 in each byte whose bit is set in a number of four bits.
fn bytes_of(bits: u32) -> u32 {
    return (bits * 0x204081u) & 0x1010101u;
}

// Where a receiver is in the grid.
struct Place {
    // Number of its texel; NO_TEXEL if it is outside the map, or rounding may move it too far.
    texel: u32,
    // Bits of its depth, an f32 above 0. A caster farther from the light does not shade it.
    depth: u32,
    // Bound on the rounding of that.
    rounding: f32,
    // Relative to the texel's centre.
    offset: vec2<f32>,
}

const NO_TEXEL: u32 = 0xffffffffu;

fn texel_number(layer: u32, texel: vec2<u32>) -> u32 {
    let size = u32(map_fit.size);
    return (layer * size + texel.y) * size + texel.x;
}

fn tile_number(layer: u32, tile: vec2<u32>) -> u32 {
    let tiles = (u32(map_fit.size) + TILE - 1u) / TILE;
    return (layer * tiles + tile.y) * tiles + tile.x;
}

// Returns the first texel of a tile that has a bit: its place in the tile, and its bit.
fn first_of(texels: vec2<u32>) -> vec2<u32> {
    let bit = countTrailingZeros(select(texels.x, texels.y, texels.x == 0u));
    return vec2(bit % TILE, bit / TILE + select(0u, 4u, texels.x == 0u));
}

fn first_bit(texels: vec2<u32>) -> vec2<u32> {
    let lowest = texels & (~texels + 1u);
    return vec2(lowest.x, select(0u, lowest.y, texels.x == 0u));
}

// The place of the lowest bit of two words.
fn first_number(bit: vec2<u32>) -> u32 {
    return select(countTrailingZeros(bit.x), 32u + countTrailingZeros(bit.y), bit.x == 0u);
}

fn bits_below(count: u32) -> u32 {
    return select((1u << min(count, 31u)) - 1u, 0xffffffffu, count >= 32u);
}

// `summed`: of `light_clip_summands_of_scene`, the same for all.
fn place_of(receiver: vec3<f32>, summed: vec2<f32>) -> Place {
    let layer = layer_of(receiver);
    let fit = fit_of(layer);
    let at = texel_of(fit, receiver);
    let error = texel_error_of_summands(fit, summed);
    // Half of the slack is for rounding, half for the tracer, to whom a point so near an edge may
    // be on it. NaN is outside.
    if is_outside_of(fit, at.xy) || !(error.x <= 0.5 * SLACK && abs(at.z) <= 2.0) {
        return Place(NO_TEXEL, 0u, 0.0, vec2(0.0));
    }
    let texel = vec2<u32>(at.xy);
    // 0 says that no receiver is there.
    let depth = max(depth_bits(at.z + error.y), 1u);
    return Place(texel_number(layer, texel), depth, 2.0 * error.y, fract(at.xy) - 0.5);
}

// In the order of the depths; of -0, too.
fn depth_bits(depth: f32) -> u32 {
    return bitcast<u32>(abs(max(depth, 0.0)));
}

// A depth in 16 bits, rounded towards the light.
fn coarse_depth(depth: f32) -> u32 {
    return u32(depth * 65535.0);
}

// An edge of an entry's caster cuts off the part of the texel where `distance + dot(inward,
// offset)` is negative, the larger component of `inward` being 1 or -1.
struct Edge {
    // As `inward_bytes` has it.
    inward: u32,
    distance: f32,
}

// A byte for either component, x above y, from -127 to 127 for -1 to 1.
fn inward_bytes(inward: vec2<f32>) -> u32 {
    let bytes = vec2<u32>(vec2<i32>(round(inward * 127.0))) & vec2(0xffu);
    return (bytes.x << 8u) | bytes.y;
}

// 16 bits for the least depth in the texel, and two edges of 24 bits: `inward`, and in the top byte
// of a word the distance, in the same numbers.
fn entry_key(depth: f32, one: Edge, other: Edge) -> vec2<u32> {
    let low = ((one.inward & 0xff00u) << 8u) | coarse_depth(depth);
    let high = ((one.inward & 0xffu) << 16u) | other.inward;
    return vec2(
        (distance_byte(one.distance, low) << 24u) | low,
        (distance_byte(other.distance, high) << 24u) | high,
    );
}

// Rounded up, the bits `below` it taken for its fraction, as `inside_of` does; and 0.0023 for the
// rounding of `inward` and `offset`.
fn distance_byte(distance: f32, below: u32) -> u32 {
    let least = i32(ceil(clamp(distance + 0.0023, -1.0, 1.0) * 127.0 * 4096.0));
    return u32((least - i32(below >> 12u) + 4095) >> 12u) & 0xffu;
}

// Negative if an edge cuts off that place, in 4096ths of a texel.
fn inside_of(key: vec2<u32>, offset: vec2<i32>) -> i32 {
    let one = signed_byte(key.x, 2u) * offset.x + signed_byte(key.y, 2u) * offset.y;
    let other = signed_byte(key.y, 1u) * offset.x + signed_byte(key.y, 0u) * offset.y;
    return (one + (i32(key.x) >> 12u)) | (other + (i32(key.y) >> 12u));
}

// Negative if a receiver of that `coarse_depth` is nearer to the light.
fn behind_of(key: vec2<u32>, coarse: u32) -> i32 {
    return i32(coarse) - i32(key.x & 0xffffu);
}

fn signed_byte(word: u32, byte: u32) -> i32 {
    return i32(word << (24u - 8u * byte)) >> 24u;
}
