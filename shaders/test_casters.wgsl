// Stage to ask, for each receiver, the casters that are listed in its texel, by the tracer's own
// test. Receivers that no complete list answers are left to a ray. `fragment`: a full-screen
// triangle, as some adapters take long to write texels in a compute stage; `compute`: one thread
// per pixel, as others take long to draw.

#import "shared/answer.wgsl"
#import "shared/camera.wgsl"
#import "shared/light_buffer.wgsl"
#import "shared/ray_triangle.wgsl"
#import "shared/receiver.wgsl"

struct Params {
    longest_list: u32,
}

var<uniform> params: Params;
// As bin_casters.wgsl leaves them: each a `Texel`, the last one LIST_LACKS for all.
var<storage, read> texels: array<vec4<u32>>;
var<storage, read> entries: array<vec4<u32>>;
// Workgroups of fill_rays in x, y, z.
var<storage, read_write> fill_groups: array<atomic<u32>, 3>;

struct Answer {
    @location(0) visibility: u32,
    @location(1) status: u32,
}

@fragment
fn fragment(@builtin(position) centre: vec4<f32>) -> Answer {
    let pixel_status = answer(vec2<u32>(centre.xy));
    return Answer(initial_visibility(pixel_status), pixel_status);
}

@compute @workgroup_size(8, 8)
fn compute(@builtin(global_invocation_id) thread: vec3<u32>) {
    if all(thread.xy < textureDimensions(primitive)) {
        store_answer(thread.xy, answer(thread.xy));
    }
}

fn answer(pixel: vec2<u32>) -> u32 {
    let receiver = textureLoad(position, pixel, 0);
    var pixel_status = initial_status(pixel, receiver);
    if pixel_status == STATUS_UNCERTAIN {
        pixel_status = test_casters(receiver.xyz, textureLoad(primitive, pixel, 0).x);
    }
    if pixel_status == STATUS_UNCERTAIN {
        ask_rays();
    }
    return pixel_status;
}

// Has the rays filled in: by one workgroup for 32 by 32 pixels.
fn ask_rays() {
    // Asked first: many need not queue.
    if atomicLoad(&fill_groups[2]) == 1u {
        return;
    }
    let groups = (textureDimensions(primitive) + 31u) / 32u;
    atomicStore(&fill_groups[0], groups.x);
    atomicStore(&fill_groups[1], groups.y);
    atomicStore(&fill_groups[2], 1u);
}

fn test_casters(receiver: vec3<f32>, own: u32) -> u32 {
    let place = place_of(receiver, light_clip_summands_of_scene());
    // A part of a large triangle is in no list.
    let lists_lack = texels[arrayLength(&texels) - 1u].y != 0u;
    if place.texel == NO_TEXEL || lists_lack {
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
    // Two shaders may round a receiver to different texels: then this texel was not marked.
    if place.depth > texel.x || texel.y > params.longest_list {
        return STATUS_UNCERTAIN;
    }
    if texel.z == LIST_END {
        return STATUS_LIGHT;
    }
    let end = light_distance(receiver);
    let ray = sheared(Ray(receiver, t_min, to_light_from(receiver), end));
    let coarse = coarse_depth(depth);
    let offset = vec2<i32>(round(place.offset * 4096.0));
    var hit = Hit(end, NO_PRIMITIVE, 0.0, 0.0);
    var is_hit = false;
    var number = texel.z;
    // Testing costs the most: threads that run in step do it together.
    while !is_hit && number != LIST_END {
        var candidate = NO_PRIMITIVE;
        while candidate == NO_PRIMITIVE && number != LIST_END {
            let entry = entries[number - 1u];
            number = entry.x;
            let inside = inside_of(entry.zw, offset) | behind_of(entry.zw, coarse);
            let may_hit = (entry.y != own) & (inside >= 0);
            candidate = select(NO_PRIMITIVE, entry.y, may_hit);
        }
        is_hit = candidate != NO_PRIMITIVE && intersect(ray, candidate, t_min, &hit);
    }
    return select(STATUS_LIGHT, STATUS_SHADOW, is_hit);
}
