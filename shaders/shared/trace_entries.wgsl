// What every engine of `Trace` binds, and its entry points: one thread per ray, workgroups spread
// over two dimensions. The engine has `fn trace(ray: Ray, skipped: u32, first_found: bool) -> Hit`.

#import "shared/groups.wgsl"
#import "shared/ray.wgsl"
#import "shared/ids.wgsl"
#import "shared/ray_total.wgsl"

var<storage, read> rays: array<Ray>;
var<storage, read> skip: array<u32>;
var<storage, read_write> hits: array<Hit>;

// As `MAX_DEPTH` in crates/scene/src/bvh/tree.rs, which builds no deeper hierarchy: a level adds
// one entry to an engine's stack at most.
const STACK_SIZE: u32 = 64u;

@compute @workgroup_size(GROUP_SIZE)
fn any_hit(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) lane: u32) {
    let ray = thread_number(group, lane);
    if ray < ray_total() {
        hits[ray] = trace(rays[ray], NO_PRIMITIVE, true);
    }
}

@compute @workgroup_size(GROUP_SIZE)
fn any_hit_skip(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    let ray = thread_number(group, lane);
    if ray < ray_total() {
        hits[ray] = trace(rays[ray], skip[ray], true);
    }
}

@compute @workgroup_size(GROUP_SIZE)
fn closest_hit(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    let ray = thread_number(group, lane);
    if ray < ray_total() {
        hits[ray] = trace(rays[ray], NO_PRIMITIVE, false);
    }
}

@compute @workgroup_size(GROUP_SIZE)
fn closest_hit_skip(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    let ray = thread_number(group, lane);
    if ray < ray_total() {
        hits[ray] = trace(rays[ray], skip[ray], false);
    }
}

fn ray_total() -> u32 {
    return min(count, min(arrayLength(&rays), arrayLength(&hits)));
}
