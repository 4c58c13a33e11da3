// What every engine of `Trace` binds, and its entry points: one thread per ray, workgroups spread
// over two dimensions. The engine has `fn trace(ray: Ray, skipped: u32, first_found: bool) -> Hit`.

#import "shared/ray.wgsl"
#import "shared/ids.wgsl"

var<storage, read> count: u32;
var<storage, read> rays: array<Ray>;
var<storage, read> skip: array<u32>;
var<storage, read_write> hits: array<Hit>;

// Both as in dispatch_arguments.wgsl.
const GROUP_SIZE: u32 = 64u;
const GROUPS_PER_ROW: u32 = 65535u;

@compute @workgroup_size(GROUP_SIZE)
fn any_hit(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) lane: u32) {
    let ray = ray_index(group, lane);
    if ray < ray_total() {
        hits[ray] = trace(rays[ray], NO_PRIMITIVE, true);
    }
}

@compute @workgroup_size(GROUP_SIZE)
fn any_hit_skip(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    let ray = ray_index(group, lane);
    if ray < ray_total() {
        hits[ray] = trace(rays[ray], skip[ray], true);
    }
}

@compute @workgroup_size(GROUP_SIZE)
fn closest_hit(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    let ray = ray_index(group, lane);
    if ray < ray_total() {
        hits[ray] = trace(rays[ray], NO_PRIMITIVE, false);
    }
}

@compute @workgroup_size(GROUP_SIZE)
fn closest_hit_skip(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    let ray = ray_index(group, lane);
    if ray < ray_total() {
        hits[ray] = trace(rays[ray], skip[ray], false);
    }
}

fn ray_index(group: vec3<u32>, lane: u32) -> u32 {
    return (group.y * GROUPS_PER_ROW + group.x) * GROUP_SIZE + lane;
}

fn ray_total() -> u32 {
    return min(count, min(arrayLength(&rays), arrayLength(&hits)));
}
