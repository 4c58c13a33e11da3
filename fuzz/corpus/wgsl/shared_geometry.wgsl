// The scene's triangles: welded positions, three indices per primitive.

var<storage, read> scene_positions: array<vec4<f32>>;
var<storage, read> scene_indices: array<u32>;

// `corner` counts the corners of all primitives: 3 * primitive + 0, 1 or 2.
fn corner_position(corner: u32) -> vec3<f32> {
    return scene_positions[scene_indices[corner]].xyz;
}
