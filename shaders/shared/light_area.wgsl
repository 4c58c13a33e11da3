// How far the light reaches around its centre. Laid out as `LightAreaUniform` in
// crates/passes/src/uniforms.rs.

struct LightArea {
    // From the light's centre, at distance 1, to its rim.
    right: vec3<f32>,
    // Length of `right` and of `up`; 0 for a light without extent.
    radius: f32,
    // The same at a right angle.
    up: vec3<f32>,
    padding: f32,
}

var<uniform> light_area: LightArea;

// From the light's centre to a point of the unit disk.
fn across_light(point: vec2<f32>) -> vec3<f32> {
    return light_area.right * point.x + light_area.up * point.y;
}

// A light without extent looks the same from each of its points: one sample does.
fn samples_needed(samples: u32) -> u32 {
    return select(samples, 1u, light_area.radius == 0.0);
}
