enable wgpu_ray_query;

var scene_tlas: acceleration_structure;

@fragment fn fragment(@builtin(position) centre: vec4<f32>) -> @location(0) f32 {
    var query: ray_query;
    let up = RayDesc(RAY_FLAG_NONE, 0xffu, 0.0, 1.0, centre.xyz, vec3(0.0, 1.0, 0.0));
    rayQueryInitialize(&query, scene_tlas, up);
    rayQueryProceed(&query);
    return rayQueryGetCommittedIntersection(&query).t;
}
