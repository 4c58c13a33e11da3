override length: u32 = 16;
var<workgroup> shared_items: array<u32, length>;
var<storage, read_write> items: array<u32>;
@compute @workgroup_size(64) fn main(@builtin(local_invocation_index) i: u32) {
    shared_items[i % 16u] = i;
    workgroupBarrier();
    items[0] = shared_items[3];
}
