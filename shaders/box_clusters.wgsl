// Stage to put a box around each cluster of casters; one thread per cluster.

#import "shared/numbered_casters.wgsl"
#import "shared/clusters.wgsl"
#import "shared/groups.wgsl"

var<storage, read_write> cluster_boxes: array<ClusterBox>;

@compute @workgroup_size(GROUP_SIZE)
fn main(thread: Thread) {
    let cluster = (thread.group.y * thread.groups.x + thread.group.x) * GROUP_SIZE + thread.lane;
    if cluster >= arrayLength(&cluster_boxes) {
        return;
    }
    let end = 3u * min(GROUP_SIZE * (cluster + 1u), caster_count());
    var box = ClusterBox(vec3(3e38), vec3(-3e38));
    for (var corner = 3u * GROUP_SIZE * cluster; corner < end; corner++) {
        let position = corner_position(corner);
        box.low = min(box.low, position);
        box.high = max(box.high, position);
    }
    cluster_boxes[cluster] = box;
}
