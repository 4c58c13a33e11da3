// The directional light and its light space. Laid out as `LightUniform` in
// crates/passes/src/uniforms.rs.

struct Light {
    // From a position relative to `centre` to the light's clip space; affine, z in 0..1 grows away
    // from the light.
    clip_from_relative: mat4x4<f32>,
    // Unit vector towards the light.
    to_light: vec3<f32>,
    // No two points of the scene are farther apart.
    max_distance: f32,
    // Centre of the scene's box: subtracted before the matrix, so that far-off scenes keep their
    // precision. w: the most that is summed up, sizes alone, for clip x or y of a point in the box.
    centre: vec4<f32>,
    // World units per unit of clip x, y, z. w: as of `centre`, for z.
    extent: vec4<f32>,
}

var<uniform> light: Light;

fn light_clip(position: vec3<f32>) -> vec3<f32> {
    return (light.clip_from_relative * vec4(position - light.centre.xyz, 1.0)).xyz;
}

// What rounding may move a receiver and the corners of its casters by, together, in shares of a
// square map's edge and of its depth: 4 half ulps each of all that is summed up for clip space,
// which is two edges wide, and on the way from there. Valid if products are fused.
fn light_space_error_bound(receiver: vec3<f32>) -> vec2<f32> {
    let matrix = transpose(light.clip_from_relative);
    let size = abs(receiver) + abs(light.centre.xyz);
    let across = max(dot(abs(matrix[0].xyz), size), dot(abs(matrix[1].xyz), size)) + light.centre.w;
    let along = dot(abs(matrix[2].xyz), size) + light.extent.w;
    return 2.3841858e-7 * vec2(0.5 * across + 1.0, along + 2.0);
}
