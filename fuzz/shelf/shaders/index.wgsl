var<storage, read_write> items: array<u32>;
@compute @workgroup_size(64) fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    items[id.x] = id.x;
}
