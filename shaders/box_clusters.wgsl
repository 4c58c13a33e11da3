// Stage to put a box around each cluster of casters; one thread per cluster.

#import "shared/numbered_casters.wgsl"
#import "shared/clusters.wgsl"
#import "shared/groups.wgsl"

var<storage, read_write> cluster_boxes: array<ClusterBox>;

// All of its bits are set in NaN and infinity.
const EXPONENT: u32 = 0x7f800000u;

@compute @workgroup_size(GROUP_SIZE)
fn main(thread: Thread) {
    let cluster = number_of(thread);
    if cluster >= arrayLength(&cluster_boxes) {
        return;
    }
    let end = 3u * min(GROUP_SIZE * (cluster + 1u), caster_count());
    var box = ClusterBox(vec3(3e38), vec3(-3e38));
    for (var corner = 3u * GROUP_SIZE * cluster; corner < end; corner++) {
        let position = corner_position(corner);
        // A triangle with a corner of a host's that is no place shades nothing, and `min` may give
        // back either of a number and NaN.
        if all((bitcast<vec3<u32>>(position) & vec3(EXPONENT)) != vec3(EXPONENT)) {
            box.low = min(box.low, position);
            box.high = max(box.high, position);
        }
    }
    cluster_boxes[cluster] = box;
}
