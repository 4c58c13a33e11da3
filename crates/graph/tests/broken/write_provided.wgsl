var<storage, read_write> scene_positions: array<vec4<f32>>;

@compute @workgroup_size(64) fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    scene_positions[id.x] = vec4<f32>(0.0);
}
