var<workgroup> few: array<u32, 4>;
var<workgroup> shared_items: array<u32, 100000>;
var<storage, read_write> items: array<u32>;
@compute @workgroup_size(64) fn main(@builtin(local_invocation_index) i: u32) {
    shared_items[i] = i;
    few[i % 4u] = i;
    workgroupBarrier();
    items[0] = shared_items[3] + few[0];
}
