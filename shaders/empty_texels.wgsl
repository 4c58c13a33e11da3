// Stage to empty the lists of all texels, for receivers; keeps how many casters each had; and the
// lists of casters. One thread per texel.

#import "shared/groups.wgsl"
#import "shared/pending.wgsl"

var<storage, read_write> texels: array<Texel>;
var<storage, read_write> pending_casters: PendingCasters;

@compute @workgroup_size(GROUP_SIZE)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) lane: u32) {
    let number = thread_number(group, lane);
    if number == 0u {
        atomicStore(&pending_casters.left[LEFT_PARTS], 0u);
        atomicStore(&pending_casters.left[LEFT_CROWDED], 0u);
        atomicStore(&pending_casters.clusters, 0u);
    }
    if number < arrayLength(&texels) {
        texels[number] = Texel(0u, 0u, 0u, texels[number].length & ~LIST_LACKS);
    }
}
