// Stage to claim places for the receivers of each tile, and to find the tiles that have any; one
// thread per tile, and one for the receivers without a texel.

#import "shared/groups.wgsl"
#import "shared/pending.wgsl"

var<storage, read_write> texels: array<PendingTexel>;
// As mark_tiles.wgsl has them, of receivers that are pending; and the most of a texel.
var<storage, read_write> tiles: array<vec4<u32>>;
var<storage, read_write> pending_state: PendingState;
var<storage, read_write> pending_boxes: array<PendingBox>;

struct Params {
    casters: u32,
}

var<uniform> params: Params;

struct Sum {
    count: u32,
    most: u32,
    tests: f32,
}

@compute @workgroup_size(GROUP_SIZE)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) lane: u32) {
    let thread = thread_number(group, lane);
    let size = u32(map_fit.size);
    let columns = (size + TILE - 1u) / TILE;
    let layer = thread / (columns * columns);
    let tile = vec2(thread % columns, thread / columns % columns);
    var sum = Sum(0u, 0u, 0.0);
    if layer >= map_layers {
        if thread == columns * columns * map_layers {
            let last = arrayLength(&texels) - 1u;
            add(last, &sum);
            // They are tested for all casters, and in no list.
            sum.tests = f32(sum.count) * f32(params.casters);
            var place = claimed(sum);
            take(last, &place);
        }
        return;
    }
    var depth = 0u;
    var taken = vec2(0u);
    for (var number = 0u; number < TILE * TILE; number++) {
        let texel = tile * TILE + vec2(number % TILE, number / TILE);
        if all(texel < vec2(size)) {
            let at = texel_number(layer, texel);
            let is_taken = add(at, &sum);
            depth = max(depth, atomicLoad(&texels[at].max_receiver_depth));
            taken[number / 32u] |= select(0u, 1u << (number % 32u), is_taken);
        }
    }
    if sum.count == 0u {
        tiles[tile_number(layer, tile)] = vec4(0u);
        return;
    }
    var place = claimed(sum);
    if place == NO_PLACE {
        depth = 0u;
        taken = vec2(0u);
    } else {
        atomicMax(&pending_boxes[layer].inverted_x, ~tile.x);
        atomicMax(&pending_boxes[layer].inverted_y, ~tile.y);
        atomicMax(&pending_boxes[layer].x, tile.x);
        atomicMax(&pending_boxes[layer].y, tile.y);
    }
    tiles[tile_number(layer, tile)] = vec4(depth, taken, sum.most);
    for (var number = 0u; number < TILE * TILE; number++) {
        let texel = tile * TILE + vec2(number % TILE, number / TILE);
        if all(texel < vec2(size)) {
            take(texel_number(layer, texel), &place);
        }
    }
}

fn add(texel: u32, sum: ptr<function, Sum>) -> bool {
    let count = atomicLoad(&texels[texel].length);
    (*sum).count += count;
    (*sum).most = max((*sum).most, count);
    (*sum).tests += f32(count) * f32(atomicLoad(&texels[texel].filled));
    return count != 0u;
}

// The first place of as many receivers, or NO_PLACE. Each tile asks for what is its own: 6 * 91^2
// of them do not overflow.
fn claimed(sum: Sum) -> u32 {
    let work = u32(min(sum.tests / f32(unit_tests), f32(MOST_WORK)));
    if work == MOST_WORK || blocks_of(sum.most) > MOST_BLOCKS {
        return NO_PLACE;
    }
    if atomicAdd(&pending_state.work, work) + work > MOST_WORK {
        // Smaller ones may still fit.
        atomicSub(&pending_state.work, work);
        return NO_PLACE;
    }
    atomicMax(&pending_state.most_blocks, blocks_of(sum.most));
    return atomicAdd(&pending_state.count, sum.count);
}

fn take(texel: u32, place: ptr<function, u32>) {
    atomicStore(&texels[texel].first, *place);
    atomicStore(&texels[texel].filled, 0u);
    if *place == NO_PLACE {
        atomicStore(&texels[texel].length, 0u);
    } else {
        *place += atomicLoad(&texels[texel].length);
    }
}
