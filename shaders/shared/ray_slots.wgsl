// The ray of a thread in a dispatch over `ray_groups`, whose workgroups are spread over two
// dimensions. Group sizes as in dispatch_arguments.wgsl.

const RAYS_PER_GROUP: u32 = 64u;
const GROUPS_PER_ROW: u32 = 65535u;

var<storage, read> ray_count: u32;

fn ray_slot(group: vec3<u32>, lane: u32) -> u32 {
    return (group.y * GROUPS_PER_ROW + group.x) * RAYS_PER_GROUP + lane;
}
