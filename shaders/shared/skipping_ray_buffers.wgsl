// In the place of shared/ray_buffers.wgsl where each ray has a primitive that it does not see.

#import "shared/ray.wgsl"

var<storage, read> rays: array<Ray>;
var<storage, read> skip: array<u32>;
var<storage, read_write> hits: array<Hit>;

fn ray_limit() -> u32 {
    return min(arrayLength(&rays), min(arrayLength(&skip), arrayLength(&hits)));
}

fn ray_of(index: u32) -> AskedRay {
    return AskedRay(rays[index], skip[index]);
}

fn take(index: u32, hit: Hit) {
    hits[index] = hit;
}
