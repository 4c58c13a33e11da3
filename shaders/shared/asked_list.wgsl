// The texel of the light buffer in which a receiver lies: an answer, or the list to ask.

#import "shared/camera.wgsl"
#import "shared/light_buffer.wgsl"
#import "shared/receiver.wgsl"

struct Params {
    longest_list: u32,
}

var<uniform> params: Params;
// As bin_casters.wgsl leaves them: each a `Texel`, the last one LIST_LACKS for all.
var<storage, read> texels: array<vec4<u32>>;
var<storage, read> entries: array<vec4<u32>>;

struct Asked {
    // Number of the first entry; LIST_END if `status` is the answer.
    head: u32,
    // Entries of the list.
    length: u32,
    // STATUS_LIGHT, STATUS_SHADOW, or STATUS_UNCERTAIN: rays decide, or the list.
    status: u32,
    // Nearer hits do not count.
    t_min: f32,
    // The receiver, as `behind_of` and `inside_of` take it.
    coarse: u32,
    offset: vec2<i32>,
}

fn asked_list(receiver: vec3<f32>) -> Asked {
    let place = place_of(receiver, light_clip_summands_of_scene());
    // A part of a large triangle is in no list.
    let lists_lack = texels[arrayLength(&texels) - 1u].y != 0u;
    if place.texel == NO_TEXEL || lists_lack {
        return answered(STATUS_UNCERTAIN);
    }
    let texel = texels[place.texel];
    let t_min = receiver_error_bound(receiver, camera.eye);
    let depth = bitcast<f32>(place.depth);
    // Twice what a hit must be away, for the tracer's rounding.
    let nearest = depth - place.rounding - 2.0 * t_min / light.extent.z;
    if nearest > 0.0 && bitcast<u32>(nearest) > ~texel.w {
        return answered(STATUS_SHADOW);
    }
    // Two shaders may round a receiver to different texels: then this texel was not marked.
    if place.depth > texel.x || texel.y > params.longest_list {
        return answered(STATUS_UNCERTAIN);
    }
    if texel.z == LIST_END {
        return answered(STATUS_LIGHT);
    }
    let offset = vec2<i32>(round(place.offset * 4096.0));
    return Asked(texel.z, texel.y, STATUS_UNCERTAIN, t_min, coarse_depth(depth), offset);
}

fn answered(status: u32) -> Asked {
    return Asked(LIST_END, 0u, status, 0.0, 0u, vec2(0));
}

// The key of an entry says that its caster may be before the receiver.
fn may_shade(asked: Asked, key: vec2<u32>) -> bool {
    return (inside_of(key, asked.offset) | behind_of(key, asked.coarse)) >= 0;
}
