// Stage to find, for each receiver, which of the samples of the light its texel's casters hide: the
// samples of shared/sample_light.ron, 64 in each turn. What is clear of rounding three planes
// decide, the rest the tracer's own test of the sample's own ray. Receivers that no list answers,
// or not within a thread's rounds, are uncertain. `status` says which half of the light counts.

#import "shared/aimed_ray.wgsl"
#import "shared/asked_list.wgsl"
#import "shared/caster_box.wgsl"
#import "shared/light_cone.wgsl"
#import "shared/ray_triangle.wgsl"
#import "shared/strata.wgsl"
#import "shared/whole_target.wgsl"

override samples: u32 = 64u;
// The turn's first.
override first_sample: u32 = 0u;

// A thread's rounds after which it gives up: docs/light_buffer_area.md has why sixteen threads in
// step then stay below 65,535, after which llvmpipe ends loops.
const MOST_ROUNDS: u32 = 4080u;
const TOO_MANY: u32 = 0xffffffffu;

// 1 if a receiver is uncertain; behind that, samples of each pixel that see the light, of the turns
// so far, or TOO_MANY.
var<storage, read_write> seen: array<atomic<u32>>;
// As box_casters.wgsl has them.
var<storage, read> boxes: array<vec4<u32>>;

struct Answer {
    @location(0) visibility: f32,
    @location(1) status: u32,
}

// A receiver and its samples.
struct Asking {
    receiver: vec3<f32>,
    own: u32,
    pixel: u32,
    // Samples of this turn, and of all.
    count: u32,
    wanted: u32,
}

@fragment
fn fragment(@builtin(position) centre: vec4<f32>) -> Answer {
    let answer = answer_of(vec2<u32>(centre.xy));
    // Asked first: many need not queue.
    if answer.status == STATUS_UNCERTAIN && atomicLoad(&seen[0]) == 0u {
        atomicStore(&seen[0], 1u);
    }
    return answer;
}

fn answer_of(pixel: vec2<u32>) -> Answer {
    let receiver = textureLoad(position, pixel, 0);
    let own = textureLoad(primitive, pixel, 0).x;
    let number = pixel.y * textureDimensions(position).x + pixel.x;
    let place = number + 1u;
    let pixel_status = initial_status(pixel, receiver);
    if pixel_status != STATUS_UNCERTAIN {
        return whole_answer(pixel_status);
    }
    if is_inside_light(receiver.xyz) {
        return whole_answer(STATUS_UNCERTAIN);
    }
    let asked = asked_list(receiver.xyz);
    if asked.head == LIST_END || is_too_wide() {
        return whole_answer(select(STATUS_UNCERTAIN, asked.status, asked.head == LIST_END));
    }
    let wanted = samples_needed(samples);
    var sum = select(atomicLoad(&seen[place]), 0u, first_sample == 0u);
    if sum != TOO_MANY && first_sample < wanted {
        let count = min(wanted - first_sample, 64u);
        let lit = lit_samples(Asking(receiver.xyz, own, number, count, wanted), asked);
        sum = select(sum + lit, TOO_MANY, lit == TOO_MANY);
    }
    atomicStore(&seen[place], sum);
    if sum == TOO_MANY {
        return whole_answer(STATUS_UNCERTAIN);
    }
    let share = f32(sum) / f32(wanted);
    return Answer(share, select(STATUS_SHADOW, STATUS_LIGHT, share >= 0.5));
}

fn whole_answer(pixel_status: u32) -> Answer {
    return Answer(f32(initial_visibility(pixel_status)), pixel_status);
}

// A turn's samples, four in each item, as `seen_point` has them.
struct Points {
    x: array<vec4<f32>, 16>,
    y: array<vec4<f32>, 16>,
}

// Unrolled: all but the jitter is known when the shader is compiled.
fn points_of(sight: Sight, pixel: u32) -> Points {
    var points: Points;
    if samples > 0u { set_four(sight, pixel, 0u, &points); }
    if samples > 4u { set_four(sight, pixel, 1u, &points); }
    if samples > 8u { set_four(sight, pixel, 2u, &points); }
    if samples > 12u { set_four(sight, pixel, 3u, &points); }
    if samples > 16u { set_four(sight, pixel, 4u, &points); }
    if samples > 20u { set_four(sight, pixel, 5u, &points); }
    if samples > 24u { set_four(sight, pixel, 6u, &points); }
    if samples > 28u { set_four(sight, pixel, 7u, &points); }
    if samples > 32u { set_four(sight, pixel, 8u, &points); }
    if samples > 36u { set_four(sight, pixel, 9u, &points); }
    if samples > 40u { set_four(sight, pixel, 10u, &points); }
    if samples > 44u { set_four(sight, pixel, 11u, &points); }
    if samples > 48u { set_four(sight, pixel, 12u, &points); }
    if samples > 52u { set_four(sight, pixel, 13u, &points); }
    if samples > 56u { set_four(sight, pixel, 14u, &points); }
    if samples > 60u { set_four(sight, pixel, 15u, &points); }
    return points;
}

fn set_four(sight: Sight, pixel: u32, item: u32, points: ptr<function, Points>) {
    let a = point_of(sight, pixel, 4u * item);
    let b = point_of(sight, pixel, 4u * item + 1u);
    let c = point_of(sight, pixel, 4u * item + 2u);
    let d = point_of(sight, pixel, 4u * item + 3u);
    (*points).x[item] = vec4(a.x, b.x, c.x, d.x);
    (*points).y[item] = vec4(a.y, b.y, c.y, d.y);
}

fn point_of(sight: Sight, pixel: u32, i: u32) -> vec2<f32> {
    return seen_point(sight, sample_point(pixel, first_sample + i, samples));
}

// A thread's way through its list.
struct Walk {
    // The next entry, and how many are left.
    number: u32,
    left: u32,
    rounds: u32,
    // Samples that no caster hides so far, one bit each.
    lit: vec2<u32>,
    // Candidates over samples that were lit when they were found, the latest first.
    found: vec4<u32>,
    // Candidates that the tracer's own test decides, the latest first, and for which samples.
    unsure: vec4<u32>,
    low: vec4<u32>,
    high: vec4<u32>,
}

// Returns how many samples of the turn no caster of the list hides. Threads run in step, and some
// adapters run what any of them could need: so candidates wait until there are four, and those with
// samples that ask the tracer's test, which are few, once more.
fn lit_samples(asking: Asking, asked: Asked) -> u32 {
    let all_lit = vec2(bits_below(asking.count), bits_below(max(asking.count, 32u) - 32u));
    let none = vec4(NO_PRIMITIVE);
    var walk = Walk(asked.head, asked.length, 0u, all_lit, none, none, vec4(0u), vec4(0u));
    let sight = sight_of(asking.receiver, asked.t_min);
    var points = points_of(sight, asking.pixel);
    var coarse = coarse_samples(asking.receiver, &points);
    loop {
        loop {
            find_candidates(asking, asked, &coarse, &walk);
            while walk.found.x != NO_PRIMITIVE && walk.unsure.w == NO_PRIMITIVE
                && walk.rounds < MOST_ROUNDS {
                test(sight, walk.found.x, &points, &walk);
                walk.found = vec4(walk.found.yzw, NO_PRIMITIVE);
                walk.rounds += 1u;
            }
            if walk.unsure.w != NO_PRIMITIVE || finds_no_other(&walk) {
                break;
            }
            walk.rounds += 3u;
        }
        ask_tracer(asking, asked.t_min, &walk);
        if (finds_no_other(&walk) && walk.found.x == NO_PRIMITIVE) || walk.rounds >= MOST_ROUNDS {
            break;
        }
        walk.rounds += 5u;
    }
    let is_lit = any(walk.lit != vec2(0u));
    let gives_up = is_lit && walk.rounds >= MOST_ROUNDS;
    return select(countOneBits(walk.lit.x) + countOneBits(walk.lit.y), TOO_MANY, gives_up);
}

fn finds_no_other(walk: ptr<function, Walk>) -> bool {
    return (*walk).left == 0u || all((*walk).lit == vec2(0u)) || (*walk).rounds >= MOST_ROUNDS;
}

// Keeps the next casters that may be before the receiver, and over a sample that is lit.
fn find_candidates(
    asking: Asking,
    asked: Asked,
    coarse: ptr<function, CoarseSamples>,
    walk: ptr<function, Walk>,
) {
    while (*walk).found.w == NO_PRIMITIVE && !finds_no_other(walk) {
        let entry = entries[(*walk).number - 1u];
        (*walk).number = entry.x;
        (*walk).left -= 1u;
        (*walk).rounds += 1u;
        let may_hit = (entry.y != asking.own) & may_shade(asked, entry.zw);
        if may_hit && any((samples_under(coarse, entry.y) & (*walk).lit) != vec2(0u)) {
            (*walk).found = vec4(entry.y, (*walk).found.xyz);
        }
    }
}

fn coarse_samples(receiver: vec3<f32>, points: ptr<function, Points>) -> CoarseSamples {
    var coarse: CoarseSamples;
    if light_kind != LIGHT_DIRECTIONAL {
        return coarse;
    }
    coarse.receiver = place_along_light(receiver);
    if samples > 0u { set_words(points, 0u, 0u, &coarse); }
    if samples > 4u { set_words(points, 1u, 4u, &coarse); }
    if samples > 8u { set_words(points, 2u, 8u, &coarse); }
    if samples > 12u { set_words(points, 3u, 12u, &coarse); }
    if samples > 32u { set_words(points, 8u, 16u, &coarse); }
    if samples > 36u { set_words(points, 9u, 20u, &coarse); }
    if samples > 40u { set_words(points, 10u, 24u, &coarse); }
    if samples > 44u { set_words(points, 11u, 28u, &coarse); }
    return coarse;
}

fn set_words(
    points: ptr<function, Points>,
    item: u32,
    first: u32,
    coarse: ptr<function, CoarseSamples>,
) {
    let x = (*points).x[item];
    let y = (*points).y[item];
    // Sixteen samples later.
    let u = (*points).x[item + 4u];
    let v = (*points).y[item + 4u];
    (*coarse).words[first] = coarse_word(vec2(x.x, y.x), vec2(u.x, v.x));
    (*coarse).words[first + 1u] = coarse_word(vec2(x.y, y.y), vec2(u.y, v.y));
    (*coarse).words[first + 2u] = coarse_word(vec2(x.z, y.z), vec2(u.z, v.z));
    (*coarse).words[first + 3u] = coarse_word(vec2(x.w, y.w), vec2(u.w, v.w));
}

// Samples that the caster's box may hide; under a spot or point light all of them.
fn samples_under(coarse: ptr<function, CoarseSamples>, primitive: u32) -> vec2<u32> {
    if light_kind != LIGHT_DIRECTIONAL {
        return vec2(0xffffffffu);
    }
    let box = coarse_box(unpacked_box(boxes[primitive]), (*coarse).receiver);
    var bits = vec2(0u);
    if samples > 0u { bits.x |= (bits_between((*coarse).words[0], box) >> 15u) & 0x10001u; }
    if samples > 1u { bits.x |= (bits_between((*coarse).words[1], box) >> 14u) & 0x20002u; }
    if samples > 2u { bits.x |= (bits_between((*coarse).words[2], box) >> 13u) & 0x40004u; }
    if samples > 3u { bits.x |= (bits_between((*coarse).words[3], box) >> 12u) & 0x80008u; }
    if samples > 4u { bits.x |= (bits_between((*coarse).words[4], box) >> 11u) & 0x100010u; }
    if samples > 5u { bits.x |= (bits_between((*coarse).words[5], box) >> 10u) & 0x200020u; }
    if samples > 6u { bits.x |= (bits_between((*coarse).words[6], box) >> 9u) & 0x400040u; }
    if samples > 7u { bits.x |= (bits_between((*coarse).words[7], box) >> 8u) & 0x800080u; }
    if samples > 8u { bits.x |= (bits_between((*coarse).words[8], box) >> 7u) & 0x1000100u; }
    if samples > 9u { bits.x |= (bits_between((*coarse).words[9], box) >> 6u) & 0x2000200u; }
    if samples > 10u { bits.x |= (bits_between((*coarse).words[10], box) >> 5u) & 0x4000400u; }
    if samples > 11u { bits.x |= (bits_between((*coarse).words[11], box) >> 4u) & 0x8000800u; }
    if samples > 12u { bits.x |= (bits_between((*coarse).words[12], box) >> 3u) & 0x10001000u; }
    if samples > 13u { bits.x |= (bits_between((*coarse).words[13], box) >> 2u) & 0x20002000u; }
    if samples > 14u { bits.x |= (bits_between((*coarse).words[14], box) >> 1u) & 0x40004000u; }
    if samples > 15u { bits.x |= (bits_between((*coarse).words[15], box) >> 0u) & 0x80008000u; }
    if samples > 32u { bits.y |= (bits_between((*coarse).words[16], box) >> 15u) & 0x10001u; }
    if samples > 33u { bits.y |= (bits_between((*coarse).words[17], box) >> 14u) & 0x20002u; }
    if samples > 34u { bits.y |= (bits_between((*coarse).words[18], box) >> 13u) & 0x40004u; }
    if samples > 35u { bits.y |= (bits_between((*coarse).words[19], box) >> 12u) & 0x80008u; }
    if samples > 36u { bits.y |= (bits_between((*coarse).words[20], box) >> 11u) & 0x100010u; }
    if samples > 37u { bits.y |= (bits_between((*coarse).words[21], box) >> 10u) & 0x200020u; }
    if samples > 38u { bits.y |= (bits_between((*coarse).words[22], box) >> 9u) & 0x400040u; }
    if samples > 39u { bits.y |= (bits_between((*coarse).words[23], box) >> 8u) & 0x800080u; }
    if samples > 40u { bits.y |= (bits_between((*coarse).words[24], box) >> 7u) & 0x1000100u; }
    if samples > 41u { bits.y |= (bits_between((*coarse).words[25], box) >> 6u) & 0x2000200u; }
    if samples > 42u { bits.y |= (bits_between((*coarse).words[26], box) >> 5u) & 0x4000400u; }
    if samples > 43u { bits.y |= (bits_between((*coarse).words[27], box) >> 4u) & 0x8000800u; }
    if samples > 44u { bits.y |= (bits_between((*coarse).words[28], box) >> 3u) & 0x10001000u; }
    if samples > 45u { bits.y |= (bits_between((*coarse).words[29], box) >> 2u) & 0x20002000u; }
    if samples > 46u { bits.y |= (bits_between((*coarse).words[30], box) >> 1u) & 0x40004000u; }
    if samples > 47u { bits.y |= (bits_between((*coarse).words[31], box) >> 0u) & 0x80008000u; }
    return select(bits, vec2(0u), box.is_behind);
}

// Takes away the samples that the candidate certainly hides, and keeps it if others are unsure.
fn test(
    sight: Sight,
    candidate: u32,
    points: ptr<function, Points>,
    walk: ptr<function, Walk>,
) {
    let cone = cone_of(sight, candidate);
    // Samples that are certainly hidden, if the cone is clear, and that perhaps are. Unrolled, so
    // that none is looked up by a number that is not known beforehand.
    var low = vec2(0u);
    var high = vec2(0u);
    if samples > 0u { low |= sides_of(cone, (*points).x[0], (*points).y[0]) << vec2(0u); }
    if samples > 4u { low |= sides_of(cone, (*points).x[1], (*points).y[1]) << vec2(4u); }
    if samples > 8u { low |= sides_of(cone, (*points).x[2], (*points).y[2]) << vec2(8u); }
    if samples > 12u { low |= sides_of(cone, (*points).x[3], (*points).y[3]) << vec2(12u); }
    if samples > 16u { low |= sides_of(cone, (*points).x[4], (*points).y[4]) << vec2(16u); }
    if samples > 20u { low |= sides_of(cone, (*points).x[5], (*points).y[5]) << vec2(20u); }
    if samples > 24u { low |= sides_of(cone, (*points).x[6], (*points).y[6]) << vec2(24u); }
    if samples > 28u { low |= sides_of(cone, (*points).x[7], (*points).y[7]) << vec2(28u); }
    if samples > 32u { high |= sides_of(cone, (*points).x[8], (*points).y[8]) << vec2(0u); }
    if samples > 36u { high |= sides_of(cone, (*points).x[9], (*points).y[9]) << vec2(4u); }
    if samples > 40u { high |= sides_of(cone, (*points).x[10], (*points).y[10]) << vec2(8u); }
    if samples > 44u { high |= sides_of(cone, (*points).x[11], (*points).y[11]) << vec2(12u); }
    if samples > 48u { high |= sides_of(cone, (*points).x[12], (*points).y[12]) << vec2(16u); }
    if samples > 52u { high |= sides_of(cone, (*points).x[13], (*points).y[13]) << vec2(20u); }
    if samples > 56u { high |= sides_of(cone, (*points).x[14], (*points).y[14]) << vec2(24u); }
    if samples > 60u { high |= sides_of(cone, (*points).x[15], (*points).y[15]) << vec2(28u); }
    // Where a mask has holes the tracer finds them.
    let is_clear = cone.is_clear && !is_masked(candidate);
    let certain = select(vec2(0u), vec2(low.x, high.x), is_clear && !cone.is_beside);
    (*walk).lit &= ~certain;
    let unsure = (*walk).lit & vec2(low.y, high.y);
    if any(unsure != vec2(0u)) && !cone.is_beside {
        (*walk).unsure = vec4(candidate, (*walk).unsure.xyz);
        (*walk).low = vec4(unsure.x, (*walk).low.xyz);
        (*walk).high = vec4(unsure.y, (*walk).high.xyz);
    }
}

// Asks the tracer's own test about all samples that are unsure, one in each round.
fn ask_tracer(
    asking: Asking,
    t_min: f32,
    walk: ptr<function, Walk>,
) {
    while (*walk).unsure.x != NO_PRIMITIVE && (*walk).rounds < MOST_ROUNDS {
        let unsure = (*walk).lit & vec2((*walk).low.x, (*walk).high.x);
        let bit = first_bit(unsure);
        let sample = first_sample + first_number(bit) % 64u;
        let point = sample_point(asking.pixel, sample, asking.wanted);
        if hides(asking.receiver, t_min, (*walk).unsure.x, point) {
            (*walk).lit &= ~bit;
        }
        let left = unsure & ~bit;
        (*walk).low.x = left.x;
        (*walk).high.x = left.y;
        (*walk).rounds += 1u;
        if all(left == vec2(0u)) {
            (*walk).unsure = vec4((*walk).unsure.yzw, NO_PRIMITIVE);
            (*walk).low = vec4((*walk).low.yzw, 0u);
            (*walk).high = vec4((*walk).high.yzw, 0u);
        }
    }
}

// The tracer's answer for the ray of a sample.
fn hides(receiver: vec3<f32>, t_min: f32, primitive: u32, point: vec2<f32>) -> bool {
    let ray = sample_ray(receiver, t_min, point);
    var hit = Hit(ray.t_max, NO_PRIMITIVE, 0.0, 0.0);
    return intersect(sheared(ray), primitive, t_min, &hit);
}
