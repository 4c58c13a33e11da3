// The perspective camera of the view. Laid out as `CameraUniform` in crates/passes/src/uniforms.rs.

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
    // near / (far - near): clip z per unit of distance before the far plane.
    depth_scale: f32,
    // Where the ray of a pixel goes through it: from its centre, in pixels, y down; and the same in
    // clip space, y up.
    jitter: vec2<f32>,
    jitter_clip: vec2<f32>,
}

var<uniform> camera: Camera;

fn relative_to_eye(position: vec3<f32>) -> vec3<f32> {
    return (position - camera.eye) - camera.eye_low;
}

// wgpu clip space: x right, y up, z from w at the near plane to 0 at the far plane. A depth is
// about near / distance then, of which f32 keeps as many digits however far it is; the other way
// round, far depths crowd below 1. Passes that draw with it clear depth to 0 and compare with
// Greater.
fn camera_clip(relative: vec3<f32>) -> vec4<f32> {
    let distance = dot(camera.forward, relative);
    return vec4(
        dot(camera.right, relative) / camera.half_width - camera.jitter_clip.x * distance,
        dot(camera.up, relative) / camera.half_height - camera.jitter_clip.y * distance,
        (camera.far - distance) * camera.depth_scale,
        distance,
    );
}

// Direction from the eye through the centre of `pixel` (y down), or what the jitter makes of it;
// its component along `forward` is 1.
fn pixel_direction(pixel: vec2<u32>, viewport: vec2<u32>) -> vec3<f32> {
    let across = (vec2<f32>(pixel) + 0.5 + camera.jitter) / vec2<f32>(viewport) * 2.0 - 1.0;
    return camera.forward
        + camera.right * (across.x * camera.half_width)
        - camera.up * (across.y * camera.half_height);
}
