// Stage to list the pixels that have a shadow ray; a workgroup takes 16 tiles of 8 by 8 pixels, a
// thread a pixel of each. The group numbers its rays by a prefix sum over one bit per pixel and
// claims their places by one atomic, so that the count never leaves the GPU and neighbours stay
// together.

#import "shared/pixel_list.wgsl"

struct Params {
    per_pixel: u32,
    first: u32,
    most: u32,
}

var<uniform> params: Params;
var status: texture_2d<u32>;
var<storage, read_write> ray_count: atomic<u32>;
var<storage, read_write> ray_pixels: array<u32>;

const TILES_PER_ROW: u32 = 4u;
const TILES: u32 = 16u;
const WORDS: u32 = 32u;

// One bit per pixel that has a ray, two words for each tile, and the place of the group's first
// ray.
var<workgroup> with_ray: array<atomic<u32>, WORDS>;
var<workgroup> group_first: u32;

@compute @workgroup_size(8, 8)
fn main(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(local_invocation_id) local: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    // Bit by bit, which of this thread's pixels have a ray.
    var mine = 0u;
    for (var tile = 0u; tile < TILES; tile++) {
        let pixel = pixel_of(group.xy, tile, local.xy);
        if is_traced(pixel) {
            mine |= 1u << tile;
            atomicOr(&with_ray[word_of(tile, lane)], 1u << (lane % 32u));
        }
    }
    workgroupBarrier();
    if lane == 0u {
        var count = 0u;
        for (var word = 0u; word < WORDS; word++) {
            count += countOneBits(atomicLoad(&with_ray[word]));
        }
        if count != 0u {
            group_first = atomicAdd(&ray_count, count);
        }
    }
    workgroupBarrier();
    var before = 0u;
    for (var tile = 0u; mine >> tile != 0u; tile++) {
        let word = word_of(tile, lane);
        let low = atomicLoad(&with_ray[2u * tile]);
        let own = atomicLoad(&with_ray[word]) & ((1u << (lane % 32u)) - 1u);
        if ((mine >> tile) & 1u) != 0u {
            let in_tile = countOneBits(own) + select(0u, countOneBits(low), lane >= 32u);
            append(group_first + before + in_tile, pixel_of(group.xy, tile, local.xy));
        }
        before += countOneBits(low) + countOneBits(atomicLoad(&with_ray[2u * tile + 1u]));
    }
}

fn word_of(tile: u32, lane: u32) -> u32 {
    return 2u * tile + lane / 32u;
}

fn pixel_of(group: vec2<u32>, tile: u32, local: vec2<u32>) -> vec2<u32> {
    return 8u * (TILES_PER_ROW * group + vec2(tile % TILES_PER_ROW, tile / TILES_PER_ROW)) + local;
}

fn is_uncertain(pixel: vec2<u32>) -> bool {
    return textureLoad(status, pixel, 0).x == STATUS_UNCERTAIN;
}

fn is_traced(pixel: vec2<u32>) -> bool {
    let viewport = textureDimensions(status);
    let place = pixel.y * viewport.x + pixel.x;
    // A place before the first one wraps to beyond the last.
    let is_inside = all(pixel < viewport) && place - params.first < params.most;
    return is_inside && (params.per_pixel != 0u || is_uncertain(pixel));
}

fn append(slot: u32, pixel: vec2<u32>) {
    let place = pixel.y * textureDimensions(status).x + pixel.x;
    // Rays of certain pixels cost their time and change no pixel.
    ray_pixels[slot] = select(place | IGNORED, place, is_uncertain(pixel));
}
