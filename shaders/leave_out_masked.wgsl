// Stage to leave masked triangles out of the inner conservative depth, for the texels that they
// cover are not known: their corners become one. One thread per triangle of select_casters.wgsl.

#import "shared/casters.wgsl"
#import "shared/masks.wgsl"
#import "shared/groups.wgsl"

// Vertices, instances, first vertex, first instance.
var<storage, read> draw_call: array<u32, 4>;
var<storage, read_write> selected: array<CasterCorner>;

@compute @workgroup_size(GROUP_SIZE)
fn main(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    let first = 3u * ((group.y * groups.x + group.x) * GROUP_SIZE + lane);
    if first >= draw_call[0] || !is_masked(selected[first].tag & PRIMITIVE) {
        return;
    }
    selected[first + 1u].texel = selected[first].texel;
    selected[first + 2u].texel = selected[first].texel;
}
