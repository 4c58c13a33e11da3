// Rays of `Trace`: for each listed pixel one to a point of the light that no frame of the last
// `period` has had.
#import "shared/pixel_list.wgsl"
#import "shared/pixel_ray.wgsl"
#import "shared/light_area.wgsl"
#import "shared/strata.wgsl"
#import "shared/frame.wgsl"

struct Params { period: u32 }
var<uniform> params: Params;
var<storage, read_write> ray_pixels: array<u32>;

fn ray_limit() -> u32 {
    return arrayLength(&ray_pixels);
}

fn ray_of(index: u32) -> AskedRay {
    let place = ray_pixels[index] & PLACE;
    let turn = frame.index % params.period;
    let point = disk_point(stratum_point(turn, params.period, random_pair(place, turn)));
    var asked = pixel_ray(listed_pixel(place, textureDimensions(primitive).x));
    asked.ray.direction += across_light(point, asked.ray.direction);
    return asked;
}

fn take(index: u32, hit: Hit) {
    ray_pixels[index] |= outcome_bits(hit.primitive);
}
