// Stage to write the receiver of each pixel: its position, and dot(n, l) of its interpolated normal
// in w; one thread per pixel.

#import "shared/drawn_pixel_receiver.wgsl"

var position: texture_storage_2d<rgba32float, write>;

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) thread: vec3<u32>) {
    if all(thread.xy < textureDimensions(primitive)) {
        textureStore(position, thread.xy, pixel_receiver(thread.xy));
    }
}
