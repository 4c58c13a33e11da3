struct Item { place: vec3<f32>, @align(32) id: u32, next: array<vec2<i32>, 4> }
var<storage, read_write> items: array<u32>;
@group(1) @binding(4) var<uniform> params: vec4<f32>;
var<workgroup> shared_items: array<Item, 16>;
@compute @workgroup_size(64) fn main(@builtin(global_invocation_id) id: vec3<u32>, @builtin(local_invocation_index) local: u32) {
    shared_items[local % 16u].id = id.x;
    workgroupBarrier();
    switch shared_items[id.x % 16u].id { case 1u, 2u: { items[id.x] = 7u; } default: { items[id.x] = bitcast<u32>(params.x); } }
}
