struct Span { near: f32, far: f32 }
var<storage, read_write> spans: array<Span>;

@compute @workgroup_size(4) fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    spans[id.x] = Span(1.0, 2.0);
}
