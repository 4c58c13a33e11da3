// The directional light and its light space. Twin of `LightUniform` in crates/passes/src/uniforms.rs.

struct Light {
    // From a position relative to `centre` to the light's clip space; affine, z in 0..1 grows away from the light.
    clip_from_relative: mat4x4<f32>,
    // Unit vector towards the light.
    towards: vec3<f32>,
    // A length beyond which nothing of the scene is met from any point in it.
    reach: f32,
    // Centre of the scene's box (w unused): subtracted before the matrix, so that far-off scenes keep their precision.
    centre: vec4<f32>,
    // World units per unit of clip x, y, z (w unused).
    extent: vec4<f32>,
}

var<uniform> light: Light;

fn light_clip(position: vec3<f32>) -> vec3<f32> {
    return (light.clip_from_relative * vec4(position - light.centre.xyz, 1.0)).xyz;
}
