// Workgroups of dispatches whose size only the GPU knows. A dimension of a dispatch ends at 65,535
// groups, and a larger indirect one silently runs nothing: the rest goes into y.

const GROUP_SIZE: u32 = 64u;
const GROUPS_PER_ROW: u32 = 65535u;

// A thread of a stage.
struct Thread {
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
}

// The number of a thread in a dispatch of as many as there are items, however it is folded.
fn number_of(thread: Thread) -> u32 {
    return (thread.group.y * thread.groups.x + thread.group.x) * GROUP_SIZE + thread.lane;
}

fn group_number(group: vec3<u32>) -> u32 {
    return group.y * GROUPS_PER_ROW + group.x;
}

fn thread_number(group: vec3<u32>, lane: u32) -> u32 {
    return group_number(group) * GROUP_SIZE + lane;
}

// Clusters of as many casters, workgroups for as many threads.
fn clusters_of(count: u32) -> u32 {
    // Not (count + 63) / 64: that overflows at the top of u32.
    return count / GROUP_SIZE + select(0u, 1u, count % GROUP_SIZE != 0u);
}

// x, y, z of a dispatch with a thread for each item.
fn groups_for(count: u32) -> array<u32, 3> {
    let needed = clusters_of(count);
    let rows = needed / GROUPS_PER_ROW + select(0u, 1u, needed % GROUPS_PER_ROW != 0u);
    return array(min(needed, GROUPS_PER_ROW), rows, 1u);
}
