// Stage to double every item.
var<storage, read> items: array<f32>;
var<storage, read_write> doubled: array<f32>;

@compute @workgroup_size(64) fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    doubled[id.x] = items[id.x] * 2.0;
}
