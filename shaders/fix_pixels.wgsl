// Stage to carry the tracer's answers back to the pixels that asked; one thread per pixel, each of which
// takes one slot of the ray buffer (there are as many), not that of its own pixel.

#import "shared/ray.wgsl"
#import "shared/ids.wgsl"

var<storage, read> ray_count: u32;
var<storage, read> ray_pixels: array<u32>;
var<storage, read> hits: array<Hit>;
var visibility: texture_storage_2d<r32uint, write>;

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) thread: vec3<u32>) {
    let viewport = textureDimensions(visibility);
    let slot = thread.y * viewport.x + thread.x;
    if any(thread.xy >= viewport) || slot >= ray_count || ray_pixels[slot] == NO_PIXEL {
        return;
    }
    let pixel = vec2(ray_pixels[slot] % viewport.x, ray_pixels[slot] / viewport.x);
    let lit = hits[slot].primitive == NO_PRIMITIVE;
    textureStore(visibility, pixel, vec4(select(0u, 1u, lit)));
}
