// Rays of `Trace`: for each listed pixel a short one into the hemisphere over its primitive.
#import "shared/pixel_list.wgsl"
#import "shared/pixel_ray.wgsl"
#import "shared/geometry.wgsl"
#import "shared/strata.wgsl"
#import "shared/frame.wgsl"

struct Params { period: u32, reach: f32 }
var<uniform> params: Params;
var<storage, read_write> ray_pixels: array<u32>;

fn ray_limit() -> u32 {
    return arrayLength(&ray_pixels);
}

fn ray_of(index: u32) -> AskedRay {
    let place = ray_pixels[index] & PLACE;
    var asked = pixel_ray(listed_pixel(place, textureDimensions(primitive).x));
    let first = 3u * asked.skipped;
    let a = corner_position(first);
    var normal = normalize(cross(corner_position(first + 1u) - a, corner_position(first + 2u) - a));
    normal *= -sign(dot(normal, relative_to_eye(asked.ray.origin)));
    let turn = frame.index % params.period;
    let point = disk_point(stratum_point(turn, params.period, random_pair(place, turn)));
    let side = normalize(cross(normal, select(vec3(1.0, 0.0, 0.0), vec3(0.0, 1.0, 0.0), abs(normal.x) > 0.5)));
    asked.ray.direction = side * point.x + cross(normal, side) * point.y + normal * sqrt(max(1.0 - dot(point, point), 0.0));
    asked.ray.t_max = params.reach;
    return asked;
}

fn take(index: u32, hit: Hit) {
    ray_pixels[index] |= outcome_bits(hit.primitive);
}
