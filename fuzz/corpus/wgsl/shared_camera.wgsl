// The perspective camera of the view. Twin of `CameraUniform` in crates/passes/src/uniforms.rs.

struct Camera {
    eye: vec3<f32>,
    near: f32,
    // Remainder of rounding the eye to f32: corners far from the origin keep their distance to the
    // eye.
    eye_low: vec3<f32>,
    far: f32,
    // Unit vectors; half_width and half_height are the image's half extents at distance 1.
    right: vec3<f32>,
    half_width: f32,
    up: vec3<f32>,
    half_height: f32,
    forward: vec3<f32>,
    // far / (far - near): clip z per unit of distance.
    depth_scale: f32,
}

var<uniform> camera: Camera;

fn relative_to_eye(position: vec3<f32>) -> vec3<f32> {
    return (position - camera.eye) - camera.eye_low;
}

// wgpu clip space: x right, y up, z from 0 at the near plane to w at the far plane.
fn camera_clip(relative: vec3<f32>) -> vec4<f32> {
    let distance = dot(camera.forward, relative);
    return vec4(
        dot(camera.right, relative) / camera.half_width,
        dot(camera.up, relative) / camera.half_height,
        (distance - camera.near) * camera.depth_scale,
        distance,
    );
}

// Direction from the eye through the centre of `pixel` (y down); its component along `forward` is 1.
fn pixel_direction(pixel: vec2<u32>, viewport: vec2<u32>) -> vec3<f32> {
    let across = (vec2<f32>(pixel) + 0.5) / vec2<f32>(viewport) * 2.0 - 1.0;
    return camera.forward
        + camera.right * (across.x * camera.half_width)
        - camera.up * (across.y * camera.half_height);
}
