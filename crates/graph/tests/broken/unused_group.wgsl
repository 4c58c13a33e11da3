@group(4) @binding(0) var<uniform> nothing: vec4f;
var<storage, read_write> items: array<u32>;
@compute @workgroup_size(1) fn main() { items[0] = 1u; }
