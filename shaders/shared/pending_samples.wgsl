// In the place of shared/pending_answer.wgsl, under a light with an extent: which of the samples of
// a receiver do casters hide, 64 in each turn? Two words have a bit for each that one hides.

#import "shared/aimed_ray.wgsl"
#import "shared/answer_shares.wgsl"
#import "shared/light_cone.wgsl"
#import "shared/pending.wgsl"
#import "shared/ray_corners.wgsl"
#import "shared/receiver.wgsl"
#import "shared/strata.wgsl"

override samples: u32 = 64u;

struct Params {
    // The turn's first.
    first_sample: u32,
}

var<uniform> params: Params;
var<storage, read_write> pending: array<atomic<u32>>;
// As test_samples.wgsl has them.
var<storage, read_write> seen: array<u32>;

// Notes which samples of the turn a caster hides from a receiver; `number` is the caster's. A round
// for each that is lit.
fn test_receiver(receiver: PendingReceiver, corners: Corners, number: u32) {
    let lit = lit_samples(receiver.place);
    if all(lit == vec2(0u)) {
        return;
    }
    let t_min = receiver_error_bound(receiver.position, camera.eye);
    let sight = sight_of(receiver.position, t_min);
    let cone = cone_of(sight, number);
    let is_bounded = receiver.is_bounded && !is_too_wide();
    if is_bounded && cone.is_beside {
        return;
    }
    let is_clear = is_bounded && cone.is_clear && !is_masked(corners.primitive);
    var hidden = vec2(0u);
    var asked = lit;
    while any(asked != vec2(0u)) {
        let bit = first_bit(asked);
        asked &= ~bit;
        let point = turn_point(receiver.pixel, first_number(bit));
        let at = seen_point(sight, point);
        // The same four times.
        let sides = sides_of(cone, vec4(at.x), vec4(at.y)) & vec2(1u);
        let is_inside = is_clear && sides.x == 1u;
        let is_unsure = !(is_bounded && sides.y == 0u);
        if is_inside || (is_unsure && hides(receiver.position, t_min, corners, point)) {
            hidden |= bit;
        }
    }
    let place = receiver_words * receiver.place;
    if hidden.x != 0u {
        atomicOr(&pending[place + 1u], hidden.x);
    }
    if hidden.y != 0u {
        atomicOr(&pending[place + 2u], hidden.y);
    }
}

// Samples of the turn that no caster hides so far, one bit each.
fn lit_samples(place: u32) -> vec2<u32> {
    let at = receiver_words * place;
    let hidden = vec2(atomicLoad(&pending[at + 1u]), atomicLoad(&pending[at + 2u]));
    let wanted = samples_needed(samples);
    let count = min(max(wanted, params.first_sample) - params.first_sample, 64u);
    return vec2(bits_below(count), bits_below(max(count, 32u) - 32u)) & ~hidden;
}

// Adds up what the turn leaves of the light, and answers a receiver, for which all casters were
// tested if `is_tested`; returns false, in the first turn, if there is no answer.
fn answer_receiver(place: u32, pixel: vec2<u32>, is_tested: bool) -> bool {
    if !is_tested {
        // No share of light.
        textureStore(visibility, pixel, vec4(-1.0));
        return params.first_sample != 0u;
    }
    let lit = lit_samples(place);
    let number = pixel.y * textureDimensions(visibility).x + pixel.x + 1u;
    let sum = select(seen[number], 0u, params.first_sample == 0u)
        + countOneBits(lit.x) + countOneBits(lit.y);
    seen[number] = sum;
    atomicStore(&pending[receiver_words * place + 1u], 0u);
    atomicStore(&pending[receiver_words * place + 2u], 0u);
    let share = f32(sum) / f32(samples_needed(samples));
    textureStore(visibility, pixel, vec4(share));
    textureStore(status, pixel, vec4(select(STATUS_SHADOW, STATUS_LIGHT, share >= 0.5)));
    return true;
}

fn turn_point(pixel: u32, i: u32) -> vec2<f32> {
    return sample_point(pixel, params.first_sample + i, samples_needed(samples));
}

// The tracer's answer for the ray of a sample.
fn hides(receiver: vec3<f32>, t_min: f32, corners: Corners, point: vec2<f32>) -> bool {
    let ray = sample_ray(receiver, t_min, point);
    var hit = Hit(ray.t_max, NO_PRIMITIVE, 0.0, 0.0);
    return intersect_corners(sheared(ray), corners, t_min, &hit);
}
