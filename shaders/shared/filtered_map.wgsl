// Where a pixel looks in a square map of depths that is blurred and has mips, and how without a
// device that filters its format.

#import "shared/depth_bias.wgsl"
#import "shared/receiver.wgsl"

struct Look {
    // True if the map decides; else `visibility` is known without it.
    at_map: bool,
    visibility: f32,
    // 0 to 1 across the map, y down.
    place: vec2<f32>,
    // From the middle of the depth range, as the map has it, so that its powers keep their digits.
    depth: f32,
    mip: f32,
    // Rise of the receiver's plane over half of the filter.
    rise: f32,
}

fn look(pixel: vec2<u32>, radius: u32) -> Look {
    let receiver = textureLoad(position, pixel, 0);
    let status = initial_status(pixel, receiver);
    if status != STATUS_UNCERTAIN {
        return Look(false, f32(initial_visibility(status)), vec2(0.0), 0.0, 0.0, 0.0);
    }
    let texel = light_texel(receiver.xyz);
    let across = step_along(pixel, vec2(1, 0), texel.xy);
    let down = step_along(pixel, vec2(0, 1), texel.xy);
    // A blurred texel already holds the mean over so many.
    let mip = log2(max(max(across, down) / f32(2u * radius + 1u), 1.0));
    let half = (f32(radius) + 1.0) * exp2(mip);
    let rise = bias_at(map_fit, receiver.xyz, texel, receiver.w, 0.0, half);
    // Outside the map nothing is known to cast a shadow.
    let at_map = !is_outside(texel.xy);
    return Look(at_map, 1.0, texel.xy / map_fit.size, texel.z - 0.5, mip, rise);
}

// Texels from a pixel's receiver to that of the next pixel: the nearer one of two, since the other
// may lie on another surface.
fn step_along(pixel: vec2<u32>, direction: vec2<i32>, texel: vec2<f32>) -> f32 {
    let last = vec2<i32>(textureDimensions(position)) - 1;
    var least = map_fit.size;
    for (var side = -1; side <= 1; side += 2) {
        let at = vec2<i32>(pixel) + side * direction;
        if any(clamp(at, vec2(0), last) != at) {
            continue;
        }
        let next = textureLoad(position, at, 0);
        if faces_light(next) {
            least = min(least, distance(light_texel(next.xyz).xy, texel));
        }
    }
    return select(least, 1.0, least == map_fit.size);
}

// Filters like a sampler with `Linear`, by one with `Nearest`, which asks nothing of a format.
fn filtered(map: texture_2d<f32>, nearest: sampler, look: Look) -> vec4<f32> {
    let coarsest = f32(textureNumLevels(map) - 1u);
    let mip = min(look.mip, coarsest);
    let finer = bilinear(map, nearest, look.place, floor(mip));
    let coarser = bilinear(map, nearest, look.place, min(floor(mip) + 1.0, coarsest));
    return mix(finer, coarser, fract(mip));
}

fn bilinear(map: texture_2d<f32>, nearest: sampler, place: vec2<f32>, mip: f32) -> vec4<f32> {
    // Halved as often, rounded down.
    let size = f32(max(textureDimensions(map).x >> u32(mip), 1u));
    let corner = place * size - 0.5;
    let part = fract(corner);
    let low = (floor(corner) + 0.5) / size;
    let high = low + 1.0 / size;
    let upper = mix(
        textureSampleLevel(map, nearest, low, mip),
        textureSampleLevel(map, nearest, vec2(high.x, low.y), mip),
        part.x,
    );
    let lower = mix(
        textureSampleLevel(map, nearest, vec2(low.x, high.y), mip),
        textureSampleLevel(map, nearest, high, mip),
        part.x,
    );
    return mix(upper, lower, part.y);
}
