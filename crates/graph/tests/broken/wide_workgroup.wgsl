var<storage, read_write> items: array<u32>;

fn main_item(index: u32) {
    items[index] = index;
}

@compute @workgroup_size(64, 64) fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    main_item(id.x);
}
