// Stage to list the receivers that no list answers, texel by texel, and from the back those that
// have no place; one thread per pixel.

#import "shared/pending.wgsl"
#import "shared/ids.wgsl"

var<storage, read_write> texels: array<PendingTexel>;
var<storage, read_write> pending_state: PendingState;
var<storage, read_write> pending: array<u32>;
var status: texture_2d<u32>;
// As count_pending.wgsl leaves them.
var visibility: texture_2d<u32>;

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) thread: vec3<u32>) {
    let size = textureDimensions(status);
    if any(thread.xy >= size) || textureLoad(status, thread.xy, 0).x != STATUS_UNCERTAIN {
        return;
    }
    let pixel = thread.y * size.x + thread.x;
    let texel = textureLoad(visibility, thread.xy, 0).x;
    let first = atomicLoad(&texels[texel].first);
    if first != NO_PLACE {
        set_receiver(first + atomicAdd(&texels[texel].filled, 1u), pixel);
    } else {
        set_receiver(size.x * size.y - 1u - atomicAdd(&pending_state.unplaced, 1u), pixel);
    }
}

fn set_receiver(place: u32, pixel: u32) {
    pending[receiver_words * place] = pixel;
    for (var word = 1u; word < receiver_words; word++) {
        pending[receiver_words * place + word] = 0u;
    }
}
