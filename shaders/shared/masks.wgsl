// Surfaces of a scene in which triangles are masked or double-sided, as crates/scene/src/mask.rs
// writes them and has the rule.

// A word per primitive: DOUBLE_SIDED, and the place of its record, 0 where it has no mask. A record
// has the texture coordinates of three corners and the place of its mask; a mask has width, height,
// how u and v are wrapped, and a bit per texel.
var<storage, read> scene_masks: array<u32>;

const DOUBLE_SIDED: u32 = 0x80000000u;
const WRAP_MIRROR: u32 = 1u;
const WRAP_CLAMP: u32 = 2u;

fn is_double_sided(primitive: u32) -> bool {
    return (scene_masks[primitive] & DOUBLE_SIDED) != 0u;
}

fn is_masked(primitive: u32) -> bool {
    return (scene_masks[primitive] & ~DOUBLE_SIDED) != 0u;
}

// Returns true if a primitive is there at the weights of its second and third corner: the nearest
// texel decides.
fn is_opaque(primitive: u32, b: f32, c: f32) -> bool {
    let record = scene_masks[primitive] & ~DOUBLE_SIDED;
    if record == 0u {
        return true;
    }
    let uv_a = corner_uv(record);
    let uv_b = corner_uv(record + 2u);
    let uv_c = corner_uv(record + 4u);
    let uv = uv_a + (b * (uv_b - uv_a) + c * (uv_c - uv_a));
    let mask = scene_masks[record + 6u];
    let size = vec2(scene_masks[mask], scene_masks[mask + 1u]);
    let wraps = scene_masks[mask + 2u];
    let at = vec2(wrapped(uv.x, wraps & 3u), wrapped(uv.y, wraps >> 2u));
    let texel = min(vec2<u32>(at * vec2<f32>(size)), size - 1u);
    let bit = texel.y * size.x + texel.x;
    return ((scene_masks[mask + 3u + bit / 32u] >> (bit % 32u)) & 1u) == 1u;
}

fn corner_uv(place: u32) -> vec2<f32> {
    return vec2(bitcast<f32>(scene_masks[place]), bitcast<f32>(scene_masks[place + 1u]));
}

fn wrapped(at: f32, wrap: u32) -> f32 {
    if wrap == WRAP_CLAMP {
        return clamp(at, 0.0, 1.0);
    }
    if wrap == WRAP_MIRROR {
        let in_two = at - 2.0 * floor(at * 0.5);
        return min(in_two, 2.0 - in_two);
    }
    return at - floor(at);
}
