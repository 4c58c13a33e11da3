// In the place of shared/ray_buffers.wgsl: for each listed pixel rays to points of the light, one
// in each part of the light's area that this turn takes, neighbours of one part side by side. Their
// answers are added up for each pixel. Cook, Porter, Carpenter, "Distributed Ray Tracing",
// SIGGRAPH 1984.

#import "shared/aimed_ray.wgsl"
#import "shared/pixel_list.wgsl"
#import "shared/pixel_ray.wgsl"
#import "shared/strata.wgsl"

struct Params {
    // Number of the turn's first sample.
    first: u32,
    samples: u32,
}

var<uniform> params: Params;
// A uniform: with masks a tracer has no storage buffer left on the least of devices.
var<uniform> asked_count: u32;
var<storage, read> ray_pixels: array<u32>;
var<storage, read_write> seen: array<atomic<u32>>;

// `count` is the samples of the turn.
fn ray_limit() -> u32 {
    return select(0xffffffffu, 0u, arrayLength(&seen) == 0u);
}

fn ray_of(index: u32) -> AskedRay {
    let part = divided(index, asked_count);
    let place = ray_pixels[part.y];
    let sample = params.first + part.x;
    let point = sample_point(place, sample, samples_needed(params.samples));
    let asked = pixel_ray(listed_pixel(place, textureDimensions(primitive).x));
    return AskedRay(aimed(asked.ray, point), asked.skipped);
}

fn take(index: u32, hit: Hit) {
    let slot = divided(index, asked_count).y;
    if hit.primitive == NO_PRIMITIVE {
        atomicAdd(&seen[slot], 1u);
    } else if hit.primitive == UNANSWERED {
        atomicOr(&seen[slot], UNANSWERED_SAMPLE);
    }
}
