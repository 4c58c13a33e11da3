// Stage to find, for each texel of the grid and for each tile, the farthest receiver that faces the
// light; one thread per pixel.

#import "shared/receiver.wgsl"
#import "shared/light_buffer.wgsl"

// Of each texel, then of each tile: bits of an f32, which are in the order of the depths; 0 where
// nobody is.
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
    if atomicLoad(&farthest[place.tile]) < place.depth {
        atomicMax(&farthest[place.tile], place.depth);
    }
    let word = place.tile + 1u + place.bit / 32u;
    let bit = 1u << (place.bit % 32u);
    if (atomicLoad(&farthest[word]) & bit) == 0u {
        atomicOr(&farthest[word], bit);
    }
}
