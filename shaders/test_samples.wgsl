// Stage to find, for each receiver, which of the samples of the light its texel's casters hide: the
// samples of shared/sample_light.ron, 64 in each turn. What is clear of rounding three planes
// decide, the rest the tracer's own test of the sample's own ray. Receivers that no list answers,
// or not within a thread's rounds, are left to rays. `status` says which half of the light counts.

#import "shared/aimed_ray.wgsl"
#import "shared/asked_list.wgsl"
#import "shared/light_cone.wgsl"
#import "shared/ray_triangle.wgsl"
#import "shared/strata.wgsl"

override samples: u32 = 64u;
// The turn's first.
override first_sample: u32 = 0u;

// Rounds of a thread's loops after which it begins no more; with the last candidate's samples and
// the points 128 more. llvmpipe ends loops after 65,535 rounds of the threads that run in step,
// sixteen of them at most.
const MOST_ROUNDS: u32 = 3900u;
const TOO_MANY: u32 = 0xffffffffu;
// Wider lights than the bounds hold for: of more than 126 degrees.
const WIDEST: f32 = 2.0;

// Samples of each pixel that see the light, of the turns so far; or TOO_MANY.
var<storage, read_write> seen: array<u32>;

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
    let pixel = vec2<u32>(centre.xy);
    let receiver = textureLoad(position, pixel, 0);
    let own = textureLoad(primitive, pixel, 0).x;
    let number = pixel.y * textureDimensions(position).x + pixel.x;
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
    var sum = select(seen[number], 0u, first_sample == 0u);
    if sum != TOO_MANY && first_sample < wanted {
        let count = min(wanted - first_sample, 64u);
        let lit = lit_samples(Asking(receiver.xyz, own, number, count, wanted), asked);
        sum = select(sum + lit, TOO_MANY, lit == TOO_MANY);
    }
    seen[number] = sum;
    if sum == TOO_MANY {
        return whole_answer(STATUS_UNCERTAIN);
    }
    let share = f32(sum) / f32(wanted);
    return Answer(share, select(STATUS_SHADOW, STATUS_LIGHT, share >= 0.5));
}

// Receivers within twice a lamp's radius ask rays: lists and bounds are for those beyond.
fn is_inside_light(receiver: vec3<f32>) -> bool {
    let way = light_way(receiver);
    return light_kind != LIGHT_DIRECTIONAL
        && !(dot(way, way) > 4.004 * light_area.radius * light_area.radius);
}

// Bounds are of lights no wider.
fn is_too_wide() -> bool {
    return light_kind == LIGHT_DIRECTIONAL && light_area.radius > WIDEST;
}

fn whole_answer(pixel_status: u32) -> Answer {
    return Answer(f32(initial_visibility(pixel_status)), pixel_status);
}

// Returns how many samples of the turn no caster of the list hides.
fn lit_samples(asking: Asking, asked: Asked) -> u32 {
    let sight = sight_of(asking.receiver, asked.t_min);
    var xs: array<vec4<f32>, 16>;
    var ys: array<vec4<f32>, 16>;
    var is_ready = false;
    var lit = vec2(bits_below(asking.count), bits_below(max(asking.count, 32u) - 32u));
    var number = asked.head;
    var rounds = 0u;
    while any(lit != vec2(0u)) && number != LIST_END && rounds < MOST_ROUNDS {
        // Threads that run in step look for a candidate together, then test it together.
        var candidate = NO_PRIMITIVE;
        while candidate == NO_PRIMITIVE && number != LIST_END && rounds < MOST_ROUNDS {
            let entry = entries[number - 1u];
            number = entry.x;
            let may_hit = (entry.y != asking.own) & may_shade(asked, entry.zw);
            candidate = select(NO_PRIMITIVE, entry.y, may_hit);
            rounds += 1u;
        }
        rounds += 1u;
        if candidate == NO_PRIMITIVE {
            continue;
        }
        let cone = cone_of(sight, candidate);
        if cone.is_beside {
            continue;
        }
        if !is_ready {
            is_ready = true;
            for (var i = 0u; i < asking.count; i++) {
                let point = seen_point(sight, sample_point(asking, i));
                xs[i / 4u][i % 4u] = point.x;
                ys[i / 4u][i % 4u] = point.y;
            }
        }
        // Samples that are certainly hidden, if the cone is clear, and that perhaps are. Unrolled,
        // so that none is looked up by a number that is not known beforehand.
        var low = vec2(0u);
        var high = vec2(0u);
        if samples > 0u { low |= sides_of(cone, xs[0], ys[0]) << vec2(0u); }
        if samples > 4u { low |= sides_of(cone, xs[1], ys[1]) << vec2(4u); }
        if samples > 8u { low |= sides_of(cone, xs[2], ys[2]) << vec2(8u); }
        if samples > 12u { low |= sides_of(cone, xs[3], ys[3]) << vec2(12u); }
        if samples > 16u { low |= sides_of(cone, xs[4], ys[4]) << vec2(16u); }
        if samples > 20u { low |= sides_of(cone, xs[5], ys[5]) << vec2(20u); }
        if samples > 24u { low |= sides_of(cone, xs[6], ys[6]) << vec2(24u); }
        if samples > 28u { low |= sides_of(cone, xs[7], ys[7]) << vec2(28u); }
        if samples > 32u { high |= sides_of(cone, xs[8], ys[8]) << vec2(0u); }
        if samples > 36u { high |= sides_of(cone, xs[9], ys[9]) << vec2(4u); }
        if samples > 40u { high |= sides_of(cone, xs[10], ys[10]) << vec2(8u); }
        if samples > 44u { high |= sides_of(cone, xs[11], ys[11]) << vec2(12u); }
        if samples > 48u { high |= sides_of(cone, xs[12], ys[12]) << vec2(16u); }
        if samples > 52u { high |= sides_of(cone, xs[13], ys[13]) << vec2(20u); }
        if samples > 56u { high |= sides_of(cone, xs[14], ys[14]) << vec2(24u); }
        if samples > 60u { high |= sides_of(cone, xs[15], ys[15]) << vec2(28u); }
        // Where a mask has holes the tracer finds them.
        let is_clear = cone.is_clear && !is_masked(candidate);
        let certain = select(vec2(0u), vec2(low.x, high.x), is_clear);
        lit &= ~certain;
        var unsure = lit & vec2(low.y, high.y);
        while any(unsure != vec2(0u)) {
            let bit = first_bit(unsure);
            unsure &= ~bit;
            rounds += 1u;
            let i = first_number(bit);
            var point = vec2(xs[i / 4u][i % 4u], ys[i / 4u][i % 4u]);
            if light_kind == LIGHT_SPOT {
                point = sample_point(asking, i);
            }
            if hides(asking.receiver, asked.t_min, candidate, point) {
                lit &= ~bit;
            }
        }
    }
    let is_done = number == LIST_END || all(lit == vec2(0u));
    return select(TOO_MANY, countOneBits(lit.x) + countOneBits(lit.y), is_done);
}

// As aim_samples.wgsl has it, of the unit disk.
fn sample_point(asking: Asking, i: u32) -> vec2<f32> {
    let sample = first_sample + i;
    return disk_point(stratum_point(sample, asking.wanted, random_pair(asking.pixel, sample)));
}

// Returns two bits for each of four samples: certainly inside of all edges; and, since a triangle
// that is not clear may be turned either way, not certainly inside of one and outside of another.
fn sides_of(cone: Cone, x: vec4<f32>, y: vec4<f32>) -> vec2<u32> {
    let ab = cone.at.x + cone.right.x * x + cone.up.x * y;
    let bc = cone.at.y + cone.right.y * x + cone.up.y * y;
    let ca = cone.at.z + cone.right.z * x + cone.up.z * y;
    let least = min(ab, min(bc, ca));
    let most = max(ab, max(bc, ca));
    let bits = vec4(1u, 2u, 4u, 8u);
    let hit = select(vec4(0u), bits, least > vec4(cone.error));
    let is_mixed = (least < vec4(-cone.error)) & (most > vec4(cone.error));
    let perhaps = select(bits, vec4(0u), is_mixed);
    return vec2(hit.x | hit.y | hit.z | hit.w, perhaps.x | perhaps.y | perhaps.z | perhaps.w);
}

// The tracer's answer for the ray of a sample.
fn hides(receiver: vec3<f32>, t_min: f32, primitive: u32, point: vec2<f32>) -> bool {
    let asked = Ray(receiver, t_min, to_light_from(receiver), light_distance(receiver));
    let ray = aimed(asked, point);
    var hit = Hit(ray.t_max, NO_PRIMITIVE, 0.0, 0.0);
    return intersect(sheared(ray), primitive, t_min, &hit);
}

fn bits_below(count: u32) -> u32 {
    return select((1u << min(count, 31u)) - 1u, 0xffffffffu, count >= 32u);
}

fn first_number(bit: vec2<u32>) -> u32 {
    return select(countTrailingZeros(bit.x), 32u + countTrailingZeros(bit.y), bit.x == 0u);
}
