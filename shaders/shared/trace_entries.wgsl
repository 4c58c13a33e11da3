// The entry points of every engine of `Trace`: one thread per ray, workgroups spread over two
// dimensions. The engine has `fn trace(ray: Ray, skipped: u32, first_found: bool) -> Hit`; where
// rays come from and hits go to is the affair of shared/ray_buffers.wgsl or its stand-in.

#import "shared/groups.wgsl"
#import "shared/ray.wgsl"
#import "shared/ids.wgsl"
#import "shared/ray_buffers.wgsl"
#import "shared/ray_total.wgsl"
#import "shared/steps.wgsl"

// As `MAX_DEPTH` in crates/scene/src/bvh/tree.rs, which builds no deeper hierarchy: a level adds
// one entry to an engine's stack at most.
const STACK_SIZE: u32 = 64u;

@compute @workgroup_size(GROUP_SIZE)
fn any_hit(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) lane: u32) {
    start_rounds(lane);
    let index = thread_number(group, lane);
    if index < ray_total() {
        answer(index, true);
    }
    store_rounds();
}

@compute @workgroup_size(GROUP_SIZE)
fn closest_hit(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    let index = thread_number(group, lane);
    if index < ray_total() {
        answer(index, false);
    }
}

// Takes a ray's hit, or that it has no answer. Nothing but the scene bounds the rounds of its way,
// and drivers may end loops without a word.
fn answer(index: u32, first_found: bool) {
    let asked = ray_of(index);
    var hit = trace(asked.ray, asked.skipped, first_found);
    let is_open = !first_found || hit.primitive == NO_PRIMITIVE;
    // An empty ray has no way.
    if loops_are_cut() && is_open && asked.ray.t_min < asked.ray.t_max {
        hit = Hit(asked.ray.t_max, UNANSWERED, 0.0, 0.0);
    }
    take(index, hit);
}

// Returns true if the driver has ended loops of this thread, which it does with all further ones:
// lavapipe counts 65,535 rounds of the loops of threads that run in step, and leaves each later
// loop after one round. So here, after the traversal, is one of two rounds. Its step, 1, is no
// constant to the compiler, which would unroll the loop.
fn loops_are_cut() -> bool {
    let step = select(1u, 2u, ray_limit() == 0u);
    var rounds = 0u;
    while rounds < 2u {
        rounds += step;
    }
    return rounds < 2u;
}

fn ray_total() -> u32 {
    return min(count, ray_limit());
}
