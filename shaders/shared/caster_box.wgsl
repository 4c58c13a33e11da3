// The box of a caster across and along the way to a directional light, and which samples of the
// light it may hide. Bounds: docs/light_buffer_area.md.

#import "shared/light_area.wgsl"
#import "shared/predicates.wgsl"

struct Box {
    low: vec3<f32>,
    high: vec3<f32>,
}

// From the scene's centre: across the light as its axes have it, and towards it.
fn place_along_light(position: vec3<f32>) -> vec3<f32> {
    let way = position - light.centre.xyz;
    let scale = 1.0 / max(light_area.radius, 1e-30);
    let x = dot(way, light_area.right) * scale;
    let y = dot(way, light_area.up) * scale;
    return vec3(x, y, dot(way, light.to_light));
}

// A bound on how far rounding may move a caster, here and in the tracer.
fn box_margin() -> f32 {
    let wide = 1.0 + light_area.radius;
    return 32.0 * HALF_ULP * wide * wide * light.max_distance;
}

// The lowest corner; and in the last word a power of two, as floats have it, and how many of these
// the box is wide, in a byte for each direction.
fn packed_box(box: Box) -> vec4<u32> {
    let size = box.high - box.low;
    let largest = max(size.x, max(size.y, max(size.z, 1e-30)));
    let step = (bitcast<u32>(largest / 254.0) + 0x7fffffu) & 0x7f800000u;
    let steps = vec3<u32>(ceil(size / bitcast<f32>(step)));
    let word = (step << 1u) | (steps.x << 16u) | (steps.y << 8u) | steps.z;
    return vec4(bitcast<vec3<u32>>(box.low), word);
}

fn unpacked_box(words: vec4<u32>) -> Box {
    let low = bitcast<vec3<f32>>(words.xyz);
    let step = bitcast<f32>((words.w >> 1u) & 0x7f800000u);
    let steps = vec3(words.w >> 16u, words.w >> 8u, words.w) & vec3(0xffu);
    return Box(low, low + vec3<f32>(vec3<i32>(steps)) * step);
}

// Bits above the bytes of two places.
const GUARDS: u32 = 0x80808080u;

// Samples of a turn as bytes, x and y of one and of the one that comes 16 later, with a guard bit
// above each; and the receiver.
struct CoarseSamples {
    words: array<u32, 32>,
    receiver: vec3<f32>,
}

// -1 to 1 in 1 to 126; others beyond.
fn coarse(at: f32) -> u32 {
    return u32(i32(clamp(62.5 * at + 63.5, 0.0, 127.0)));
}

fn coarse_word(one: vec2<f32>, other: vec2<f32>) -> u32 {
    let low = coarse(one.x) | (coarse(one.y) << 8u);
    return GUARDS | low | (coarse(other.x) << 16u) | (coarse(other.y) << 24u);
}

// The box as samples see it from the receiver: words that hold the least and the most of their
// bytes twice, for `bits_between`.
struct CoarseBox {
    least: u32,
    most: u32,
    // True if all of it is farther from the light than the receiver.
    is_behind: bool,
}

fn coarse_box(box: Box, receiver: vec3<f32>) -> CoarseBox {
    let low = box.low - receiver;
    let high = box.high - receiver;
    let at_nearest = 1.0 / max(low.z * light_area.radius, 1e-30);
    let at_farthest = 1.0 / max(high.z * light_area.radius, 1e-30);
    let x = coarse_range(low.x, high.x, at_nearest, at_farthest);
    let y = coarse_range(low.y, high.y, at_nearest, at_farthest);
    let least = (x.x | (y.x << 8u)) * 0x10001u;
    let most = (x.y | (y.y << 8u)) * 0x10001u + 2u * GUARDS;
    return CoarseBox(least, most, high.z < 0.0);
}

// A hundredth of a step for rounding.
fn coarse_range(low: f32, high: f32, at_nearest: f32, at_farthest: f32) -> vec2<u32> {
    let least = low * select(at_farthest, at_nearest, low < 0.0);
    let most = high * select(at_nearest, at_farthest, high < 0.0);
    return vec2(
        u32(i32(clamp(62.5 * least + 63.49, 0.0, 127.0))),
        u32(i32(clamp(62.5 * most + 63.51, 0.0, 127.0))),
    );
}

// Bit 15 if the one sample of a word is in the box, 31 for the other. Guards keep each byte from
// borrowing from the next.
fn bits_between(word: u32, box: CoarseBox) -> u32 {
    let within = (word - box.least) & (box.most - word);
    return within & (within << 8u);
}
