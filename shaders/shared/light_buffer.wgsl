// A grid over light space, each texel with the list of the casters that could shade a receiver in
// it. Haines, Greenberg, "The Light Buffer: A Shadow-Testing Accelerator", IEEE CG&A 6(9), 1986.
// Why it is exact: docs/light_buffer.md.

#import "shared/light_triangle.wgsl"
#import "shared/map_layers.wgsl"

// One caster in the list of a texel.
struct Entry {
    // Number of the next entry; LIST_END after the last one, LIST_FULL where a caster is missing.
    next: u32,
    // Whom it cannot shade, see `entry_key`.
    key: u32,
    primitive: u32,
}

// Entries count from 1, so that a cleared buffer holds empty lists.
const LIST_END: u32 = 0u;
const LIST_FULL: u32 = 0xffffffffu;

// Some of the tiles under the box of a large triangle, from `first_tile` on.
struct Part {
    primitive: u32,
    first_tile: u32,
}

// Edge of a tile, texels. Behind the texels' depths in `farthest`, those of all layers, a tile has
// three words: the farthest depth of its texels, and a bit for each of them, row by row, that
// somebody is in.
const TILE: u32 = 8u;

// The layer of the grid whose lists a pass makes; `map_fit` is its.
override binned_layer: u32 = 0u;

// Where a receiver is in the grid.
struct Place {
    // Number of its texel; NO_TEXEL if it is outside the map, or rounding may move it too far.
    texel: u32,
    // Bits of its depth, an f32 above 0. What is farther from the light does not shade it.
    depth: u32,
    // Relative to the texel's centre.
    offset: vec2<f32>,
}

const NO_TEXEL: u32 = 0xffffffffu;

// In `farthest`: of a texel, and of the first word of a tile.
fn texel_number(layer: u32, texel: vec2<u32>) -> u32 {
    let size = u32(map_fit.size);
    return (layer * size + texel.y) * size + texel.x;
}

fn tile_number(layer: u32, tile: vec2<u32>) -> u32 {
    let size = u32(map_fit.size);
    let tiles = (size + TILE - 1u) / TILE;
    return map_layers * size * size + 3u * ((layer * tiles + tile.y) * tiles + tile.x);
}

fn place_of(receiver: vec3<f32>) -> Place {
    let layer = layer_of(receiver);
    let fit = fit_of(layer);
    let at = texel_of(fit, receiver);
    let error = texel_error_bound_of(fit, receiver);
    // Half of the slack is for rounding, half for the tracer, to whom a point so near an edge may
    // be on it. NaN is outside.
    if is_outside_of(fit, at.xy) || !(error.x <= 0.5 * SLACK && abs(at.z) <= 2.0) {
        return Place(NO_TEXEL, 0u, vec2(0.0));
    }
    let texel = vec2<u32>(at.xy);
    // 0 says that nobody is there.
    let depth = max(depth_bits(at.z + error.y), 1u);
    return Place(texel_number(layer, texel), depth, fract(at.xy) - 0.5);
}

// In the order of the depths; of -0, too.
fn depth_bits(depth: f32) -> u32 {
    return bitcast<u32>(abs(max(depth, 0.0)));
}

// A depth in 16 bits, rounded towards the light.
fn coarse_depth(depth: f32) -> u32 {
    return u32(depth * 65535.0);
}

// The line `distance + dot(inward, offset) = 0` cuts off the part of a texel in which an entry's
// caster is not; the larger component of `inward` is 1 or -1. 16 bits for the least depth in the
// texel, 2 for the larger component, 6 for the smaller one, 8 for the distance.
fn entry_key(depth: f32, inward: vec2<f32>, distance: f32) -> u32 {
    let steep = abs(inward.y) > abs(inward.x);
    let larger = select(inward.x, inward.y, steep);
    let smaller = select(inward.y, inward.x, steep);
    // The slack in both directions, and 1/126 for the smaller component's rounding.
    let generous = clamp(distance + 4.0 * SLACK, -1.0, 1.0);
    return coarse_depth(depth) << 16u
        | select(0u, 0x8000u, steep)
        | select(0u, 0x4000u, larger < 0.0)
        | u32(round((smaller + 1.0) * 31.5)) << 8u
        | u32(ceil((generous + 1.0) * 127.5));
}

fn key_depth(key: u32) -> u32 {
    return key >> 16u;
}

fn cuts_off(key: u32, offset: vec2<f32>) -> bool {
    let steep = (key & 0x8000u) != 0u;
    let larger = select(offset.x, offset.y, steep);
    let smaller = select(offset.y, offset.x, steep);
    let distance = f32(key & 0xffu) / 127.5 - 1.0;
    let slope = f32(key >> 8u & 0x3fu) / 31.5 - 1.0;
    return distance + select(larger, -larger, (key & 0x4000u) != 0u) + slope * smaller < 0.0;
}
