#import "shared/camera.wgsl"
#import "shared/light.wgsl"
#import "shared/geometry.wgsl"

// 6 corners: 0..2 the triangle, 3..5 extruded. 8 triangles, outward winding of a triangle seen from its front.
const CORNERS = array<u32, 24>(0, 2, 1,  5, 3, 4,  0, 4, 3,  0, 1, 4,  1, 5, 4,  1, 2, 5,  2, 3, 5,  2, 0, 3);

@vertex
fn vertex(@builtin(vertex_index) v: u32, @builtin(instance_index) primitive: u32) -> @builtin(position) vec4<f32> {
    let a = corner_position(3u * primitive);
    let b = corner_position(3u * primitive + 1u);
    let c = corner_position(3u * primitive + 2u);
    if dot(cross(b - a, c - a), light.to_light) >= 0.0 { return vec4(0.0, 0.0, 0.0, 1.0); }
    var corners = CORNERS;
    let k = corners[v];
    var p = select(light.to_light * -light.max_distance, vec3(0.0), k < 3u);
    p += select(select(c, b, k % 3u == 1u), a, k % 3u == 0u);
    return camera_clip(relative_to_eye(p));
}

@fragment
fn fragment(@builtin(front_facing) front: bool) -> @location(0) f32 {
    return select(1.0, -1.0, front);
}
