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

// 4 half ulps: what clip space is off by, for each unit of what is summed up. Valid if products are
// fused.
const CLIP_ROUNDING: f32 = 2.3841858e-7;

// All that is summed up, sizes alone, for clip x or y, and for clip z, of a receiver and of the
// corners of its casters.
fn light_clip_summands(receiver: vec3<f32>) -> vec2<f32> {
    let matrix = transpose(light.clip_from_relative);
    let size = abs(receiver) + abs(light.centre.xyz);
    let across = max(dot(abs(matrix[0].xyz), size), dot(abs(matrix[1].xyz), size));
    return vec2(across + light.centre.w, dot(abs(matrix[2].xyz), size) + light.extent.w);
}
