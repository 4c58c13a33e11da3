// Stage to add one to what was there.
var age_previous: texture_2d<f32>;

@fragment fn fragment(@builtin(position) position: vec4<f32>) -> @location(0) f32 {
    return textureLoad(age_previous, vec2<u32>(position.xy), 0).x + 1.0;
}
