// Stage to ask, for each receiver, the casters that are listed in its texel, by the tracer's own
// test; one thread for 4 pixels. What no complete list answers is left to a ray.

#import "shared/answer.wgsl"
#import "shared/camera.wgsl"
#import "shared/receiver.wgsl"
#import "shared/light_buffer.wgsl"
#import "shared/pixel_tiles.wgsl"
#import "shared/ray_triangle.wgsl"

struct Params {
    longest_list: u32,
}

struct List {
    head: u32,
    length: u32,
}

var<uniform> params: Params;
// As mark_receivers.wgsl has it.
var<storage, read> farthest: array<u32>;
// As bin_casters.wgsl has them.
var<storage, read> lists: array<List>;
var<storage, read> entries: array<Entry>;
// Workgroups of fill_rays in x, y, z.
var<storage, read_write> fill_groups: array<atomic<u32>, 3>;

// Of a workgroup.
const TILES_PER_ROW: u32 = 2u;
const TILES: u32 = 4u;

@compute @workgroup_size(8, 8)
fn main(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    // Blocks of 4 by 2 pixels: neighbours that run in step have like lists.
    let column = (lane & 3u) | (lane >> 1u & 4u);
    let row = (lane >> 2u & 1u) | (lane >> 3u & 6u);
    for (var tile = 0u; tile < TILES; tile++) {
        answer(pixel_of(group.xy, tile, TILES_PER_ROW, vec2(column, row)));
    }
}

fn answer(pixel: vec2<u32>) {
    if any(pixel >= textureDimensions(primitive)) {
        return;
    }
    let receiver = textureLoad(position, pixel, 0);
    var pixel_status = initial_status(pixel, receiver);
    if pixel_status == STATUS_UNCERTAIN {
        pixel_status = test_casters(receiver.xyz, textureLoad(primitive, pixel, 0).x);
    }
    if pixel_status == STATUS_UNCERTAIN {
        ask_rays();
    }
    store_answer(pixel, pixel_status);
}

// Has the rays filled in: by one workgroup for 32 by 32 pixels.
fn ask_rays() {
    // Asked first: many need not queue.
    if atomicLoad(&fill_groups[2]) == 1u {
        return;
    }
    let groups = (textureDimensions(status) + 31u) / 32u;
    atomicStore(&fill_groups[0], groups.x);
    atomicStore(&fill_groups[1], groups.y);
    atomicStore(&fill_groups[2], 1u);
}

fn test_casters(receiver: vec3<f32>, own: u32) -> u32 {
    let place = place_of(receiver);
    // A part of a large triangle that had no room is in no list.
    if place.texel == NO_TEXEL || lists[arrayLength(&lists) - 1u].head == LIST_FULL {
        return STATUS_UNCERTAIN;
    }
    // Two shaders may round a receiver to different texels: then nobody has marked this one.
    if place.depth > farthest[place.texel] {
        return STATUS_UNCERTAIN;
    }
    let list = lists[place.texel];
    if list.length == 0u {
        return STATUS_LIGHT;
    }
    if list.length > params.longest_list || list.head == LIST_FULL {
        return STATUS_UNCERTAIN;
    }
    var walk = Walk(list.head, coarse_depth(bitcast<f32>(place.depth)), place.offset, own);
    let t_min = receiver_error_bound(receiver, camera.eye);
    let end = light_distance(receiver);
    let ray = sheared(Ray(receiver, t_min, to_light_from(receiver), end));
    var hit = Hit(end, NO_PRIMITIVE, 0.0, 0.0);
    var is_hit = false;
    // Testing costs the most: threads that run in step do it together.
    loop {
        let candidate = next_candidate(&walk);
        is_hit = candidate != NO_PRIMITIVE && intersect(ray, candidate, t_min, &hit);
        if is_hit || !is_entry(walk.number) {
            break;
        }
    }
    if is_hit {
        return STATUS_SHADOW;
    }
    return select(STATUS_UNCERTAIN, STATUS_LIGHT, walk.number == LIST_END);
}

// A receiver's way through its list.
struct Walk {
    // Of the next entry.
    number: u32,
    // Of the receiver.
    depth: u32,
    offset: vec2<f32>,
    own: u32,
}

// The next caster that could be hit; NO_PRIMITIVE if there is none. Only while there are entries.
fn next_candidate(walk: ptr<function, Walk>) -> u32 {
    var candidate = NO_PRIMITIVE;
    loop {
        let at = (*walk).number - 1u;
        let key = entries[at].key;
        let primitive = entries[at].primitive;
        let may_hit = primitive != (*walk).own && key_depth(key) <= (*walk).depth
            && !cuts_off(key, (*walk).offset);
        candidate = select(NO_PRIMITIVE, primitive, may_hit);
        (*walk).number = entries[at].next;
        if may_hit || !is_entry((*walk).number) {
            break;
        }
    }
    return candidate;
}

fn is_entry(number: u32) -> bool {
    return number != LIST_END && number != LIST_FULL;
}
