// Stage to draw the primitive id of the nearest front face in each pixel, by vertex pulling (three
// vertices per primitive). A visibility buffer: Burns and Hunt, "The Visibility Buffer", JCGT 2(2),
// 2013.

#import "shared/camera.wgsl"
#import "shared/geometry.wgsl"
#import "shared/ids.wgsl"
#import "shared/pixel_weights.wgsl"
#import "shared/solid.wgsl"

struct Params {
    target_size: vec2<u32>,
}

var<uniform> params: Params;

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

// Where triangles are masked or double-sided: drawn without culling, a fragment is left out where
// its mask is not opaque, or where a single-sided primitive is seen from behind.
@fragment
fn fragment_masked(vertex: Vertex) -> @location(0) u32 {
    let first = 3u * vertex.primitive;
    let at = pixel_weights(
        pixel_direction(vec2<u32>(vertex.clip.xy), params.target_size),
        relative_to_eye(corner_position(first)),
        relative_to_eye(corner_position(first + 1u)),
        relative_to_eye(corner_position(first + 2u)),
    );
    if at.from_behind && !is_double_sided(vertex.primitive) {
        discard;
    }
    if !is_opaque(vertex.primitive, at.weights.y, at.weights.z) {
        discard;
    }
    return vertex.primitive;
}
