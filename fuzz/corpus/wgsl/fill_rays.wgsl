// Stage to append one shadow ray per uncertain pixel; one thread per pixel. Each workgroup numbers its rays by a prefix sum over one bit
// per thread and claims their places by one atomic, so that the count never leaves the GPU and neighbours stay together.

#import "shared/camera.wgsl"
#import "shared/light.wgsl"
#import "shared/ray.wgsl"
#import "shared/ids.wgsl"

struct Params {
    per_pixel: u32,
}

var<uniform> params: Params;
var primitive: texture_2d<u32>;
var position: texture_2d<f32>;
var status: texture_2d<u32>;
var<storage, read_write> ray_count: atomic<u32>;
var<storage, read_write> rays: array<Ray>;
var<storage, read_write> ray_primitives: array<u32>;
var<storage, read_write> ray_pixels: array<u32>;

// One bit per thread that has a ray, and the place of the group's first ray.
var<workgroup> asking: array<atomic<u32>, 2>;
var<workgroup> group_first: u32;

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) thread: vec3<u32>, @builtin(local_invocation_index) lane: u32) {
    let pixel = thread.xy;
    let viewport = textureDimensions(status);
    let inside = all(pixel < viewport);
    let asks = inside && textureLoad(status, pixel, 0).x == STATUS_UNCERTAIN;
    let traced = asks || (inside && params.per_pixel != 0u);
    let word = lane / 32u;
    let bit = 1u << (lane % 32u);
    if traced {
        atomicOr(&asking[word], bit);
    }
    workgroupBarrier();
    let low = atomicLoad(&asking[0]);
    let high = atomicLoad(&asking[1]);
    if lane == 0u && (low | high) != 0u {
        group_first = atomicAdd(&ray_count, countOneBits(low) + countOneBits(high));
    }
    workgroupBarrier();
    if !traced {
        return;
    }

    let before = select(countOneBits(low & (bit - 1u)), countOneBits(low) + countOneBits(high & (bit - 1u)), word == 1u);
    let slot = group_first + before;
    let id = textureLoad(primitive, pixel, 0).x;
    let receiver = textureLoad(position, pixel, 0).xyz;
    // The background has no receiver: its ray is empty.
    let reach = select(light.reach, -1.0, id == NO_PRIMITIVE);
    rays[slot] = Ray(receiver, own_rounding(receiver), light.towards, reach);
    ray_primitives[slot] = id;
    // Rays of pixels that ask nothing cost their time and change no pixel.
    ray_pixels[slot] = select(NO_PIXEL, pixel.y * viewport.x + pixel.x, asks);
}

// Bound on the rounding of the receiver, half an ulp of its distance to the origin and to the eye:
// a surface that is met sooner is the receiver's own, beyond an edge.
fn own_rounding(receiver: vec3<f32>) -> f32 {
    return 5.9604645e-8 * (length(receiver) + length(receiver - camera.eye));
}
