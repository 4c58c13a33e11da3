struct Span { far: f32, near: f32 }
var<storage, read> spans: array<Span>;
var<storage, read_write> lengths: array<f32>;

@compute @workgroup_size(4) fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    lengths[id.x] = spans[id.x].far - spans[id.x].near;
}
