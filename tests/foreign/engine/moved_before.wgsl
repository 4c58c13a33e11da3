// Where a place on a primitive was in the frame before, if the mesh has moved.

#import "shared/geometry.wgsl"

var<storage, read> scene_positions_previous: array<vec4<f32>>;

fn place_before(id: u32, place: vec3<f32>) -> vec3<f32> {
    let a = corner_position(3u * id);
    let ab = corner_position(3u * id + 1u) - a;
    let ac = corner_position(3u * id + 2u) - a;
    let n = cross(ab, ac);
    let square = max(dot(n, n), 1e-30);
    let b = dot(cross(place - a, ac), n) / square;
    let c = dot(cross(ab, place - a), n) / square;
    let i = vec3(scene_indices[3u * id], scene_indices[3u * id + 1u], scene_indices[3u * id + 2u]);
    let before = scene_positions_previous[i.x].xyz;
    return before + b * (scene_positions_previous[i.y].xyz - before) + c * (scene_positions_previous[i.z].xyz - before);
}
