struct Span { near: f32, steps: u32 }
var<storage, read> spans: array<Span>;
var<storage, read_write> lengths: array<f32>;

@compute @workgroup_size(4) fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    lengths[id.x] = f32(spans[id.x].steps) - spans[id.x].near;
}
