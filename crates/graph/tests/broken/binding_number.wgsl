@group(0) @binding(1000) var<storage, read_write> items: array<u32>;
@compute @workgroup_size(1) fn main() { items[0] = 1u; }
