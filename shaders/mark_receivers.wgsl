// Stage to find, for each texel of the grid, the farthest receiver that faces the light; one thread
// per pixel.

#import "shared/receiver.wgsl"
#import "shared/light_buffer.wgsl"

// Of each texel: bits of an f32, which are in the order of the depths; 0 where nobody is. Behind
// them is what mark_tiles.wgsl writes.
var<storage, read_write> farthest: array<atomic<u32>>;

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
    let place = place_of(receiver.xyz);
    if place.texel == NO_TEXEL {
        return;
    }
    // Asked first: many receivers of one texel need not queue for it.
    if atomicLoad(&farthest[place.texel]) < place.depth {
        atomicMax(&farthest[place.texel], place.depth);
    }
}
