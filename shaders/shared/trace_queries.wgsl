// How the device's own ray queries trace for `Trace`. A shader that imports this enables
// wgpu_ray_query. The custom data of an instance is the id of its first primitive.

#import "shared/trace_entries.wgsl"
#import "shared/solid.wgsl"

var scene_tlas: acceleration_structure;

const ALL_INSTANCES: u32 = 0xffu;

fn trace(ray: Ray, skipped: u32, first_found: bool) -> Hit {
    let missed = Hit(ray.t_max, NO_PRIMITIVE, 0.0, 0.0);
    if !(ray.t_min < ray.t_max) || all(ray.direction == vec3(0.0)) {
        return missed;
    }
    let flags = select(RAY_FLAG_NONE, RAY_FLAG_TERMINATE_ON_FIRST_HIT, first_found);
    let asked = RayDesc(
        flags, ALL_INSTANCES, ray.t_min, ray.t_max, ray.origin, ray.direction,
    );
    var query: ray_query;
    rayQueryInitialize(&query, scene_tlas, asked);
    while rayQueryProceed(&query) {
        let found = rayQueryGetCandidateIntersection(&query);
        let primitive = found.instance_custom_data + found.primitive_index;
        let weights = found.barycentrics;
        // The interval is open below, whatever the device holds.
        if primitive != skipped
            && found.t > ray.t_min
            && is_opaque(primitive, weights.x, weights.y) {
            rayQueryConfirmIntersection(&query);
        }
    }
    let found = rayQueryGetCommittedIntersection(&query);
    if found.kind == RAY_QUERY_INTERSECTION_NONE {
        return missed;
    }
    let primitive = found.instance_custom_data + found.primitive_index;
    return Hit(found.t, primitive, found.barycentrics.x, found.barycentrics.y);
}
