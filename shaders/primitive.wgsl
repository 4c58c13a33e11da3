// Stage to draw the primitive id of the nearest front face in each pixel, by vertex pulling (three
// vertices per primitive). A visibility buffer: Burns and Hunt, "The Visibility Buffer", JCGT 2(2),
// 2013.

#import "shared/camera.wgsl"
#import "shared/geometry.wgsl"
#import "shared/ids.wgsl"

struct Vertex {
    @builtin(position) clip: vec4<f32>,
    @location(0) @interpolate(flat) primitive: u32,
}

@vertex
fn vertex(@builtin(vertex_index) corner: u32) -> Vertex {
    return Vertex(camera_clip(relative_to_eye(corner_position(corner))), corner / 3u);
}

@fragment
fn fragment(vertex: Vertex) -> @location(0) u32 {
    return vertex.primitive;
}
