// Stage to read two textures: one whose name is as it stands, one that could be either of two.
var im_age: texture_2d<f32>;
var a_b_c: texture_2d<f32>;
@fragment fn fragment(@builtin(position) position: vec4<f32>) -> @location(0) f32 {
    return textureLoad(im_age, vec2<u32>(position.xy), 0).x + textureLoad(a_b_c, vec2<u32>(position.xy), 0).x;
}
