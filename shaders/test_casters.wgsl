// Stage to ask, for each receiver, the casters that are listed in its texel, by the tracer's own
// test; `main`: one thread for 16 pixels, which leaves those with long lists to `long`: one thread
// per pixel. What no complete list answers is left to a ray.

#import "shared/answer.wgsl"
#import "shared/camera.wgsl"
#import "shared/groups.wgsl"
#import "shared/facing.wgsl"
#import "shared/light_buffer.wgsl"
#import "shared/pixel_blocks.wgsl"
#import "shared/ray_triangle.wgsl"

struct Params {
    longest_list: u32,
}

var<uniform> params: Params;
// As mark_receivers.wgsl reads it.
var position: texture_storage_2d<rgba32float, read>;
// As bin_casters.wgsl leaves them: each a `Texel`, the last one LIST_LACKS for all.
var<storage, read> texels: array<vec4<u32>>;
var<storage, read> entries: array<vec4<u32>>;
// Of pixels with long lists, how many there are, then which: one buffer, as eight are all that a
// stage is sure to have.
var<storage, read_write> long_pixels: array<atomic<u32>>;
// Workgroups of fill_rays in x, y, z.
var<storage, read_write> fill_groups: array<atomic<u32>, 3>;

// So that no thread's loops run for more than 65,535 rounds, see docs/light_buffer.md.
const LONG_LIST: u32 = 224u;
// Besides those of `status`: the pixel is one for `long`.
const IS_LONG: u32 = 0xffffffffu;

// What receivers have in common.
struct Shared {
    // The rays of a directional light.
    rays: Sheared,
    // See `place_of`.
    summed: vec2<f32>,
    // A part of a large triangle is in no list.
    lists_lack: bool,
}

@compute @workgroup_size(8, 8)
fn main(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    let facts = what_all_share();
    for (var block = 0u; block < BLOCKS; block++) {
        let pixel = pixel_of(group.xy, lane, block);
        if all(pixel < textureDimensions(primitive)) {
            answer(pixel, facts, min(params.longest_list, LONG_LIST));
        }
    }
}

@compute @workgroup_size(GROUP_SIZE)
fn long(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    let slot = thread_number(group, lane);
    if slot >= atomicLoad(&long_pixels[0]) {
        return;
    }
    let width = textureDimensions(primitive).x;
    let number = atomicLoad(&long_pixels[slot + 1u]);
    answer(vec2(number % width, number / width), what_all_share(), params.longest_list);
}

// `longest`: the longest list that is walked at once.
fn answer(pixel: vec2<u32>, facts: Shared, longest: u32) {
    let receiver = textureLoad(position, pixel);
    var pixel_status = initial_status(pixel, receiver);
    if pixel_status == STATUS_UNCERTAIN {
        let own = textureLoad(primitive, pixel, 0).x;
        pixel_status = test_casters(receiver.xyz, own, facts, longest);
    }
    if pixel_status == IS_LONG {
        let slot = atomicAdd(&long_pixels[0], 1u);
        atomicStore(&long_pixels[slot + 1u], pixel.y * textureDimensions(primitive).x + pixel.x);
        return;
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

fn what_all_share() -> Shared {
    let rays = sheared(Ray(vec3(0.0), 0.0, light.to_light, light.max_distance));
    let lists_lack = texels[arrayLength(&texels) - 1u].y != 0u;
    return Shared(rays, light_clip_summands_of_scene(), lists_lack);
}

fn test_casters(receiver: vec3<f32>, own: u32, facts: Shared, longest: u32) -> u32 {
    let place = place_of(receiver, facts.summed);
    if place.texel == NO_TEXEL || facts.lists_lack {
        return STATUS_UNCERTAIN;
    }
    let texel = texels[place.texel];
    let t_min = receiver_error_bound(receiver, camera.eye);
    let depth = bitcast<f32>(place.depth);
    // Twice what a hit must be away, for the tracer's rounding.
    let nearest = depth - place.rounding - 2.0 * t_min / light.extent.z;
    if nearest > 0.0 && bitcast<u32>(nearest) > ~texel.w {
        return STATUS_SHADOW;
    }
    // Two shaders may round a receiver to different texels: then nobody has marked this one.
    if place.depth > texel.x || texel.y > params.longest_list {
        return STATUS_UNCERTAIN;
    }
    if texel.y > longest {
        return IS_LONG;
    }
    if texel.z == LIST_END {
        return STATUS_LIGHT;
    }
    let end = light_distance(receiver);
    var ray = Sheared(receiver, facts.rays.longest, facts.rays.shear);
    if light_kind != LIGHT_DIRECTIONAL {
        ray = sheared(Ray(receiver, t_min, to_light_from(receiver), end));
    }
    let coarse = coarse_depth(depth);
    let offset = vec2<i32>(round(place.offset * 4096.0));
    var hit = Hit(end, NO_PRIMITIVE, 0.0, 0.0);
    var is_hit = false;
    var number = texel.z;
    // Testing costs the most: threads that run in step do it together.
    loop {
        var candidate = NO_PRIMITIVE;
        loop {
            let entry = entries[number - 1u];
            number = entry.x;
            let inside = inside_of(entry.zw, offset) | behind_of(entry.zw, coarse);
            let may_hit = (entry.y != own) & (inside >= 0);
            candidate = select(NO_PRIMITIVE, entry.y, may_hit);
            if may_hit || number == LIST_END {
                break;
            }
        }
        is_hit = candidate != NO_PRIMITIVE && intersect(ray, candidate, t_min, &hit);
        if is_hit || number == LIST_END {
            break;
        }
    }
    return select(STATUS_LIGHT, STATUS_SHADOW, is_hit);
}
