// Workgroups of dispatches whose size only the GPU knows. A dimension of a dispatch ends at 65,535
// groups, and a larger indirect one silently runs nothing: the rest goes into y.

const GROUP_SIZE: u32 = 64u;
const GROUPS_PER_ROW: u32 = 65535u;

fn group_number(group: vec3<u32>) -> u32 {
    return group.y * GROUPS_PER_ROW + group.x;
}

fn thread_number(group: vec3<u32>, lane: u32) -> u32 {
    return group_number(group) * GROUP_SIZE + lane;
}
