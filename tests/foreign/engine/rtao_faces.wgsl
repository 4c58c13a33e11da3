// Stage to ask a ray of every pixel that shows a surface; one thread per pixel.

#import "shared/answer.wgsl"
#import "shared/receiver.wgsl"

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) thread: vec3<u32>) {
    if all(thread.xy < textureDimensions(primitive)) {
        let is_background = textureLoad(primitive, thread.xy, 0).x == NO_PRIMITIVE;
        store_answer(thread.xy, select(STATUS_UNCERTAIN, STATUS_BACKGROUND, is_background));
    }
}
