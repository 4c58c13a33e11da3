// How places come back from a depth buffer. Laid out as `UnprojectionUniform` in
// crates/passes/src/uniforms.rs.

struct Unprojection {
    // From clip space to the world relative to `origin`, to be divided by w.
    relative_from_clip: mat4x4<f32>,
    // The eye, rounded, and what that left over.
    origin: vec3<f32>,
    // 1 if depth 1 is near.
    is_reversed: u32,
    origin_low: vec3<f32>,
    padding: f32,
}

var<uniform> unprojection: Unprojection;

// Returns the depth of a place beyond everything.
fn farthest_depth() -> f32 {
    return select(1.0, 0.0, unprojection.is_reversed != 0u);
}

// A depth that is by so much nearer.
fn nearer_depth(depth: f32, by: f32) -> f32 {
    return depth + select(-by, by, unprojection.is_reversed != 0u);
}

// The place at that depth that the centre of `pixel` (y down) shows, relative to the eye.
fn relative_at_depth(pixel: vec2<u32>, viewport: vec2<u32>, depth: f32) -> vec3<f32> {
    let across = (vec2<f32>(pixel) + 0.5) / vec2<f32>(viewport) * 2.0 - 1.0;
    let place = unprojection.relative_from_clip * vec4(across.x, -across.y, depth, 1.0);
    return place.xyz / place.w;
}
