// Stage to draw the scene's depth as the light sees it; triangles from the host's vertex buffer.

var<uniform> light: mat4x4<f32>;
var<storage, read> scene_vertices: array<vec4<f32>>;

@vertex fn vertex(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> {
    return light * scene_vertices[index];
}
