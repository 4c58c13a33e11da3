fn brightness(at: vec2<f32>) -> f32 {
    return at.x;
}

@fragment fn fragment(@builtin(position) centre: vec4<f32>) -> @location(0) f32 {
    return brigthness(centre.xy);
}
