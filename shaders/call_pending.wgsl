// Stage to turn the parts and casters that bin_pending.wgsl left into workgroups; a single thread.

#import "shared/groups.wgsl"
#import "shared/pending.wgsl"

struct Params {
    casters: u32,
}

var<uniform> params: Params;
var<storage, read_write> pending_state: PendingState;
var<storage, read_write> pending_casters: PendingCasters;
// The first item is 1 if a receiver is uncertain.
var<storage, read> is_any_uncertain: array<u32>;
var<storage, read_write> layer_calls: array<Call>;
// The layer's.
var<storage, read_write> pending_box: PendingBox;
// Workgroups of `bin_small`.
var<storage, read_write> live_groups: array<u32, 3>;

@compute @workgroup_size(1)
fn main() {
    let blocks = atomicLoad(&pending_state.most_blocks);
    // Else nothing has set these counts.
    if is_any_uncertain[0] == 0u {
        call(CALL_LARGE, vec3(0u));
        call(CALL_CROWDED, vec3(0u));
        return;
    }
    // For the next layer.
    atomicStore(&pending_casters.clusters, 0u);
    live_groups = array(0u, 0u, 0u);
    let parts = atomicExchange(&pending_casters.left[LEFT_PARTS], 0u);
    pending_box.parts = parts;
    pending_box.crowded = atomicExchange(&pending_casters.left[LEFT_CROWDED], 0u);
    let crowded = groups_for(pending_box.crowded);
    let words = clusters_of(params.casters) + params.casters + 2u * parts;
    pending_state.needed_words = max(pending_state.needed_words, words);
    if words > arrayLength(&pending_casters.words) {
        pending_state.parts_lack = 1u;
    }
    let rows = parts / GROUPS_PER_ROW + select(0u, 1u, parts % GROUPS_PER_ROW != 0u);
    call(CALL_LARGE, vec3(min(parts, GROUPS_PER_ROW), rows, blocks));
    call(CALL_CROWDED, vec3(crowded[0], crowded[1], max(blocks, 1u) - 1u));
}

fn call(number: u32, groups: vec3<u32>) {
    layer_calls[number].x = groups.x;
    layer_calls[number].y = groups.y;
    layer_calls[number].z = groups.z;
}
