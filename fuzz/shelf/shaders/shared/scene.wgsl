var<storage, read> scene_positions: array<vec4<f32>>;
var<storage, read> scene_indices: array<u32>;
var<uniform> camera: mat4x4<f32>;
fn corner(index: u32) -> vec4<f32> { return scene_positions[scene_indices[index]]; }
