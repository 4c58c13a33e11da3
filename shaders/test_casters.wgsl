// Stage to ask, for each receiver, the casters that are listed in its texel, by the tracer's own
// test; a thread for each pixel. Receivers that no complete list answers are uncertain.

#import "shared/answer.wgsl"
#import "shared/asked_list.wgsl"
#import "shared/ray_triangle.wgsl"

// One item: 1 if a receiver is uncertain.
var<storage, read_write> is_any_uncertain: array<atomic<u32>>;

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) thread: vec3<u32>) {
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
    // Asked first: many need not queue.
    if pixel_status == STATUS_UNCERTAIN && atomicLoad(&is_any_uncertain[0]) == 0u {
        atomicStore(&is_any_uncertain[0], 1u);
    }
    return pixel_status;
}

fn test_casters(receiver: vec3<f32>, own: u32) -> u32 {
    let asked = asked_list(receiver);
    if asked.head == LIST_END {
        return asked.status;
    }
    let end = light_distance(receiver);
    let ray = sheared(Ray(receiver, asked.t_min, to_light_from(receiver), end));
    var hit = Hit(end, NO_PRIMITIVE, 0.0, 0.0);
    var is_hit = false;
    var number = asked.head;
    // Testing costs the most: threads that run in step do it together.
    while !is_hit && number != LIST_END {
        var candidate = NO_PRIMITIVE;
        while candidate == NO_PRIMITIVE && number != LIST_END {
            let entry = entries[number - 1u];
            number = entry.x;
            let may_hit = (entry.y != own) & may_shade(asked, entry.zw);
            candidate = select(NO_PRIMITIVE, entry.y, may_hit);
        }
        is_hit = candidate != NO_PRIMITIVE && intersect(ray, candidate, asked.t_min, &hit);
    }
    return select(STATUS_LIGHT, STATUS_SHADOW, is_hit);
}
