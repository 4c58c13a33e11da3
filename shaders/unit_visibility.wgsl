// Stage to write a method's answer as a share of the light from 0 to 1; a full-screen triangle.

var answer: texture_2d<u32>;
var share: texture_2d<f32>;

// Over a method that answers 1 lit or 0 in shadow.
@fragment
fn hard(@builtin(position) centre: vec4<f32>) -> @location(0) f32 {
    return f32(min(textureLoad(answer, vec2<u32>(centre.xy), 0).x, 1u));
}

// Over one that answers with a share of the light.
@fragment
fn graded(@builtin(position) centre: vec4<f32>) -> @location(0) f32 {
    return clamp(textureLoad(share, vec2<u32>(centre.xy), 0).x, 0.0, 1.0);
}
