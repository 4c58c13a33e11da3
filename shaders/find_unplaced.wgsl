// Stage to list the triangles that have no place in a spot light's map and may cover some of it.
// Those of which rounding hides what they cover may cover all of it: the nearest of their depths
// stands for all. One thread per caster.

#import "shared/all_cast.wgsl"
#import "shared/face_triangle.wgsl"
#import "shared/groups.wgsl"
#import "shared/ids.wgsl"
#import "shared/unplaced.wgsl"

// Primitives, one of them NO_PRIMITIVE, for those that may cover all of the map.
var<storage, read_write> unplaced: array<u32>;
// Vertices, instances, first vertex, first instance.
var<storage, read_write> unplaced_call: array<atomic<u32>, 4>;
var<storage, read_write> unplaced_nearest: atomic<u32>;

@compute @workgroup_size(GROUP_SIZE)
fn main(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    let number = (group.y * groups.x + group.x) * GROUP_SIZE + lane;
    if number == 0u {
        add(NO_PRIMITIVE);
    }
    if number >= caster_count() {
        return;
    }
    let primitive = caster_primitive(number);
    if is_placed(light_triangle(primitive)) {
        return;
    }
    let anywhere = face_triangle(primitive);
    if anywhere.beside {
        return;
    }
    if anywhere.volume == 0.0 {
        atomicMax(&unplaced_nearest, nearness(saturate(anywhere.nearest)));
    } else {
        add(primitive);
    }
}

fn add(primitive: u32) {
    unplaced[atomicAdd(&unplaced_call[0], 3u) / 3u] = primitive;
    atomicStore(&unplaced_call[1], 1u);
}
