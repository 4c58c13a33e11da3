// Stage to find, for each texel of the grid, the farthest receiver that faces the light; one thread
// for 16 pixels.

#import "shared/light_buffer.wgsl"
#import "shared/pixel_blocks.wgsl"
#import "shared/receiver.wgsl"

var<storage, read_write> texels: array<BinnedTexel>;

@compute @workgroup_size(8, 8)
fn main(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    let summed = light_clip_summands_of_scene();
    for (var block = 0u; block < BLOCKS; block++) {
        mark(pixel_of(group.xy, lane, block), summed);
    }
}

fn mark(pixel: vec2<u32>, summed: vec2<f32>) {
    if any(pixel >= textureDimensions(position)) {
        return;
    }
    let receiver = textureLoad(position, pixel, 0);
    if !faces_light(receiver) {
        return;
    }
    let place = place_of(receiver.xyz, summed);
    if place.texel == NO_TEXEL {
        return;
    }
    // Asked first: many receivers of one texel need not queue for it.
    if atomicLoad(&texels[place.texel].max_receiver_depth) < place.depth {
        atomicMax(&texels[place.texel].max_receiver_depth, place.depth);
    }
}
