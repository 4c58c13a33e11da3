// Stage to leave every pixel that faces the light to the samples, and to decide all others; one
// thread per pixel.

#import "shared/receiver.wgsl"

var visibility: texture_storage_2d<r32float, write>;
var status: texture_storage_2d<r32uint, write>;

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) thread: vec3<u32>) {
    let pixel = thread.xy;
    if any(pixel >= textureDimensions(primitive)) {
        return;
    }
    let pixel_status = initial_status(pixel, textureLoad(position, pixel, 0));
    textureStore(status, pixel, vec4(pixel_status));
    textureStore(visibility, pixel, vec4(f32(initial_visibility(pixel_status))));
}
