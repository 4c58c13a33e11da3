// In the place of shared/ray_buffers.wgsl: shadow rays made from the pixels of a list
// (shared/fill_rays.ron), which keeps what they met. fix_pixels.wgsl carries it to the pixels.

#import "shared/pixel_list.wgsl"
#import "shared/pixel_ray.wgsl"

var<storage, read_write> ray_pixels: array<u32>;

fn ray_limit() -> u32 {
    return arrayLength(&ray_pixels);
}

fn ray_of(index: u32) -> AskedRay {
    return pixel_ray(listed_pixel(ray_pixels[index], textureDimensions(primitive).x));
}

fn take(index: u32, hit: Hit) {
    ray_pixels[index] |= outcome_bits(hit.primitive);
}
