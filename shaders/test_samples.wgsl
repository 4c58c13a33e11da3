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
// the points 130 more. llvmpipe ends loops after 65,535 rounds of the threads that run in step,
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
        let first = inside_of_edges(cone.sides, cone.error, &xs, &ys);
        // Where a mask has holes the tracer finds them.
        let is_clear = cone.is_clear && !is_masked(candidate);
        lit &= ~select(vec2(0u), first.bits, is_clear);
        // Samples near an edge, perhaps inside of all; of a triangle that may be turned either way
        // those that are perhaps outside of all, too.
        var unsure = vec2(0u);
        var turn = select(0u, 2u, is_clear && first.nearest > cone.error);
        while turn < 2u {
            let sides = turned(cone.sides, turn == 1u);
            unsure |= lit & inside_of_edges(sides, -cone.error, &xs, &ys).bits;
            turn += select(1u, 2u, is_clear);
            rounds += 1u;
        }
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

struct Inside {
    // A bit for each sample of the turn.
    bits: vec2<u32>,
    // How near a sample is to an edge's line, as `error` is measured.
    nearest: f32,
}

// Samples that are farther inside of all edges than that. Unrolled, so that none is looked up by a
// number that is not known beforehand.
fn inside_of_edges(
    sides: Sides,
    error: f32,
    xs: ptr<function, array<vec4<f32>, 16>>,
    ys: ptr<function, array<vec4<f32>, 16>>,
) -> Inside {
    var bits = vec2(0u);
    var near = vec4(3e38);
    if samples > 0u { bits.x |= inside_bits(sides, error, (*xs)[0], (*ys)[0], &near) << 0u; }
    if samples > 4u { bits.x |= inside_bits(sides, error, (*xs)[1], (*ys)[1], &near) << 4u; }
    if samples > 8u { bits.x |= inside_bits(sides, error, (*xs)[2], (*ys)[2], &near) << 8u; }
    if samples > 12u { bits.x |= inside_bits(sides, error, (*xs)[3], (*ys)[3], &near) << 12u; }
    if samples > 16u { bits.x |= inside_bits(sides, error, (*xs)[4], (*ys)[4], &near) << 16u; }
    if samples > 20u { bits.x |= inside_bits(sides, error, (*xs)[5], (*ys)[5], &near) << 20u; }
    if samples > 24u { bits.x |= inside_bits(sides, error, (*xs)[6], (*ys)[6], &near) << 24u; }
    if samples > 28u { bits.x |= inside_bits(sides, error, (*xs)[7], (*ys)[7], &near) << 28u; }
    if samples > 32u { bits.y |= inside_bits(sides, error, (*xs)[8], (*ys)[8], &near) << 0u; }
    if samples > 36u { bits.y |= inside_bits(sides, error, (*xs)[9], (*ys)[9], &near) << 4u; }
    if samples > 40u { bits.y |= inside_bits(sides, error, (*xs)[10], (*ys)[10], &near) << 8u; }
    if samples > 44u { bits.y |= inside_bits(sides, error, (*xs)[11], (*ys)[11], &near) << 12u; }
    if samples > 48u { bits.y |= inside_bits(sides, error, (*xs)[12], (*ys)[12], &near) << 16u; }
    if samples > 52u { bits.y |= inside_bits(sides, error, (*xs)[13], (*ys)[13], &near) << 20u; }
    if samples > 56u { bits.y |= inside_bits(sides, error, (*xs)[14], (*ys)[14], &near) << 24u; }
    if samples > 60u { bits.y |= inside_bits(sides, error, (*xs)[15], (*ys)[15], &near) << 28u; }
    return Inside(bits, min(min(near.x, near.y), min(near.z, near.w)));
}

// The same for four samples.
fn inside_bits(
    sides: Sides,
    error: f32,
    x: vec4<f32>,
    y: vec4<f32>,
    near: ptr<function, vec4<f32>>,
) -> u32 {
    let ab = sides.at.x + sides.right.x * x + sides.up.x * y;
    let bc = sides.at.y + sides.right.y * x + sides.up.y * y;
    let ca = sides.at.z + sides.right.z * x + sides.up.z * y;
    let least = min(ab, min(bc, ca));
    *near = min(*near, abs(least));
    let bits = select(vec4(0u), vec4(1u, 2u, 4u, 8u), least > vec4(error));
    return bits.x | bits.y | bits.z | bits.w;
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
