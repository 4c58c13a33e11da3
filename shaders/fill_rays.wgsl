// Stage to append one shadow ray per pixel that faces the light, and to settle all other pixels; one thread per pixel.
// Each workgroup claims its rays by one atomic, so that the count never leaves the GPU and neighbours stay together.

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
var visibility: texture_storage_2d<r32uint, write>;
var status: texture_storage_2d<r32uint, write>;
var<storage, read_write> ray_count: atomic<u32>;
var<storage, read_write> rays: array<Ray>;
var<storage, read_write> ray_primitives: array<u32>;
var<storage, read_write> ray_pixels: array<u32>;

var<workgroup> group_rays: atomic<u32>;
var<workgroup> group_first: u32;

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) thread: vec3<u32>, @builtin(local_invocation_index) lane: u32) {
    let pixel = thread.xy;
    let viewport = textureDimensions(primitive);
    let inside = all(pixel < viewport);
    var id = NO_PRIMITIVE;
    var receiver = vec4(0.0);
    var pixel_status = STATUS_BACKGROUND;
    if inside {
        id = textureLoad(primitive, pixel, 0).x;
        receiver = textureLoad(position, pixel, 0);
        if id != NO_PRIMITIVE {
            pixel_status = select(STATUS_FACING_AWAY, STATUS_UNCERTAIN, receiver.w > 0.0);
        }
        textureStore(status, pixel, vec4(pixel_status));
        textureStore(visibility, pixel, vec4(base_visibility(pixel_status)));
    }

    let asks = pixel_status == STATUS_UNCERTAIN;
    let traced = inside && (asks || params.per_pixel != 0u);
    var slot = 0u;
    if traced {
        slot = atomicAdd(&group_rays, 1u);
    }
    workgroupBarrier();
    if lane == 0u {
        group_first = atomicAdd(&ray_count, atomicLoad(&group_rays));
    }
    workgroupBarrier();
    if traced {
        slot += group_first;
        // The background has no receiver: its ray is empty.
        let reach = select(light.reach, -1.0, id == NO_PRIMITIVE);
        rays[slot] = Ray(receiver.xyz, own_rounding(receiver.xyz), light.towards, reach);
        ray_primitives[slot] = id;
        // Rays of pixels that ask nothing cost their time and change no pixel.
        ray_pixels[slot] = select(NO_PIXEL, pixel.y * viewport.x + pixel.x, asks);
    }
}

// What rounding may have moved the receiver by, half an ulp of its distance to the origin and to the eye: a surface that is met
// sooner is the receiver's own, beyond an edge.
fn own_rounding(receiver: vec3<f32>) -> f32 {
    return 5.9604645e-8 * (length(receiver) + length(receiver - camera.eye));
}
