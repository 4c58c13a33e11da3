// Stage to find the box, across light space, around the receivers that face the light; one thread
// per pixel.

#import "shared/receiver.wgsl"
#import "shared/light.wgsl"

// Bits of f32 from 0 to 1, which are in the order of the numbers: the greatest x, y, 1 - x and
// 1 - y in shares of the scene's edge. All 0 if there is no receiver.
var<storage, read_write> receiver_box: array<atomic<u32>, 4>;

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) thread: vec3<u32>) {
    let pixel = thread.xy;
    if any(pixel >= textureDimensions(position)) {
        return;
    }
    let receiver = textureLoad(position, pixel, 0);
    if !faces_light(receiver) {
        return;
    }
    let clip = light_clip(receiver.xyz);
    let at = vec2(clip.x, -clip.y) * 0.5 + 0.5;
    raise(0u, at.x);
    raise(1u, at.y);
    raise(2u, 1.0 - at.x);
    raise(3u, 1.0 - at.y);
}

fn raise(side: u32, share: f32) {
    let bits = bitcast<u32>(abs(saturate(share)));
    // Asked first: hardly any of many receivers needs to queue.
    if atomicLoad(&receiver_box[side]) < bits {
        atomicMax(&receiver_box[side], bits);
    }
}
