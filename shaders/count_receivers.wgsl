// Stage to count the receivers that face the light; one thread for 16 pixels.

#import "shared/pixel_blocks.wgsl"
#import "shared/receiver.wgsl"

var<storage, read_write> estimate: array<atomic<u32>, 3>;

var<workgroup> here: atomic<u32>;

@compute @workgroup_size(8, 8)
fn main(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    var count = 0u;
    for (var block = 0u; block < BLOCKS; block++) {
        let pixel = pixel_of(group.xy, lane, block);
        if all(pixel < textureDimensions(position)) {
            count += select(0u, 1u, faces_light(textureLoad(position, pixel, 0)));
        }
    }
    atomicAdd(&here, count);
    workgroupBarrier();
    if lane == 0u {
        atomicAdd(&estimate[2], atomicLoad(&here));
    }
}
