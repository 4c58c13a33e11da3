// Where a place on a primitive was in the frame before: `moved_before.wgsl` stands in for this where
// meshes move.

fn place_before(id: u32, place: vec3<f32>) -> vec3<f32> {
    return place;
}
