// The entry point of a stage that decides each pixel or leaves it to a tracer; one thread per
// pixel. The importing file has `fn compare(receiver: vec3<f32>) -> u32`: the status of a receiver
// that faces the light.

#import "shared/answer.wgsl"
#import "shared/pixel_receiver.wgsl"

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) thread: vec3<u32>) {
    let pixel = thread.xy;
    if any(pixel >= textureDimensions(primitive)) {
        return;
    }
    let receiver = pixel_receiver(pixel);
    var pixel_status = initial_status(pixel, receiver);
    if pixel_status == STATUS_UNCERTAIN {
        pixel_status = compare(receiver.xyz);
    }
    store_answer(pixel, pixel_status);
}
