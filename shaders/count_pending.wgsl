// Stage to count, for each texel, the receivers that no list answers, and to find the farthest;
// those without a texel, and those that bounds of casters do not hold for, belong to the last one.
// Keeps the texel of each in `visibility`. One thread per pixel.

#import "shared/binned_caster.wgsl"
#import "shared/pending.wgsl"
#import "shared/receiver.wgsl"

var<storage, read_write> texels: array<PendingTexel>;
var status: texture_2d<u32>;
var visibility: texture_storage_2d<r32uint, write>;

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) thread: vec3<u32>) {
    let size = textureDimensions(status);
    if any(thread.xy >= size) || textureLoad(status, thread.xy, 0).x != STATUS_UNCERTAIN {
        return;
    }
    let receiver = textureLoad(position, thread.xy, 0);
    let place = place_of(receiver.xyz, light_clip_summands_of_scene());
    let has_texel = place.texel != NO_TEXEL && is_bounded(receiver.xyz, place.depth);
    let texel = select(arrayLength(&texels) - 1u, place.texel, has_texel);
    // Two shaders may round a receiver to different texels: so this is done once.
    textureStore(visibility, thread.xy, vec4(texel));
    atomicAdd(&texels[texel].length, 1u);
    atomicMax(&texels[texel].max_receiver_depth, place.depth);
}
