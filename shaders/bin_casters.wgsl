// Stage to append each caster to the lists of the texels that it overlaps and in which some
// receiver is not nearer to the light. `bin_small`: one thread per caster of the clusters that are
// live, which leaves those over many tiles to `bin_large`: a workgroup for one or two parts of
// large ones. So no thread looks at more than 2,048 texels, however large a triangle is.

#import "shared/numbered_casters.wgsl"
#import "shared/groups.wgsl"
#import "shared/ids.wgsl"
#import "shared/binning.wgsl"

@compute @workgroup_size(GROUP_SIZE)
fn bin_small(thread: Thread) {
    start_rounds(thread.lane);
    let group = group_number(thread.group);
    var number = NO_PRIMITIVE;
    if group < atomicLoad(&live_clusters.count) {
        number = live_clusters.numbers[group] * GROUP_SIZE + thread.lane;
    }
    bin_caster(number, thread.lane);
    store_rounds();
}

@compute @workgroup_size(GROUP_SIZE)
fn bin_large(thread: Thread) {
    start_rounds(thread.lane);
    bin_parts(group_number(thread.group), thread.lane);
    store_rounds();
}
