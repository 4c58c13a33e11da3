// The tiles and texels that a caster is listed in.

#import "shared/binned_caster.wgsl"
#import "shared/entry_keys.wgsl"
#import "shared/linked_lists.wgsl"
#import "shared/steps.wgsl"

// As mark_tiles.wgsl has them.
var<storage, read> tiles: array<vec4<u32>>;
// Texels of the grid; behind them one that says LIST_LACKS if a part of a large triangle had no
// room.
var<storage, read_write> texels: array<BinnedTexel>;

// As `Texel` has it.
var<storage, read_write> entries: array<vec4<u32>>;

// True if a caster is there wherever its triangle is, and depths are those of the light's space: no
// mask, a directional light.
override has_covers: bool = false;

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
        begin_round();
        var inside = vec2(0u);
        var at = tile;
        while all(inside == vec2(0u)) && number < end {
            at = tile;
            count_step(TILE_STEP);
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
            count_step(TEXEL_STEP);
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
        var slot = reserved_slots(entries_here);
        while any(listed != vec2(0u)) {
            count_step(ENTRY_STEP);
            append(caster, at * TILE + first_of(listed), slot, lines);
            listed &= ~first_bit(listed);
            slot += 1u;
        }
    }
}

// Returns true if the caster may shade a receiver in a texel, around that centre, whose farthest
// one has a depth of those bits.
fn may_shade_texel(caster: Binned, centre: vec2<f32>, max_depth_bits_here: u32) -> bool {
    let may_shade = depth_bits(least_depth(caster, centre)) <= max_depth_bits_here;
    let shading = shading_functions(caster, centre, bitcast<f32>(max_depth_bits_here));
    return all(shading >= -caster.edge_threshold) && may_shade;
}

// Returns true if a texel's list gets the caster.
fn is_listed(caster: Binned, texel: vec2<u32>) -> bool {
    let number = texel_number(binned_layer, texel);
    let centre = vec2<f32>(texel) + 0.5;
    let depth_bits_here = atomicLoad(&texels[number].max_receiver_depth);
    let max_depth = bitcast<f32>(depth_bits_here);
    if !may_shade_texel(caster, centre, depth_bits_here) {
        return false;
    }
    // The texel, larger by 4 times the slack on every side, is inside of what covers it.
    let enlarged = (1.0 + 6.0 * caster.dilation) * caster.edge_threshold;
    let inset = enlarged + cover_inset(caster, centre, max_depth);
    let covers = caster.plane.margin >= 0.0
        && all(edge_functions(caster.triangle, centre) >= inset);
    if has_covers && covers {
        let depth = covered_depth(caster, centre);
        atomicMax(&texels[number].full_coverage_depth, ~depth_bits(depth));
        // No receiver behind it asks a list.
        atomicMin(&texels[number].max_receiver_depth, depth_bits(depth + cover_margin()));
    }
    return is_within_list(number);
}

// A receiver farther from the light, in a texel that the caster covers, has all of its triangle
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
    let max_depth = bitcast<f32>(marked.x);
    let shading = shading_functions(caster, middle, max_depth);
    let box = shaded_texels(caster, max_depth);
    let may_shade = depth_bits(depth) <= marked.x && is_tile_wanted(marked)
        && all(shading >= -f32(TILE) * caster.edge_threshold);
    return select(vec2(0u), tile_bits(box.xy, box.zw, tile) & marked.yz, may_shade);
}

fn append(caster: Binned, texel: vec2<u32>, slot: u32, lines: Lines) {
    let number = texel_number(binned_layer, texel);
    let centre = vec2<f32>(texel) + 0.5;
    let inward = shading_functions(caster, centre, shaded_depth(number));
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
    append_entry(number, slot, caster.number, key);
}
