// Stage to draw a hill that fills a small part of the range of brightness; a full-screen triangle.

@fragment fn fragment(@builtin(position) centre: vec4<f32>) -> @location(0) f32 {
    let offset = (centre.xy - vec2(32.0, 12.0)) / vec2(32.0, 12.0);
    return 0.4 + 0.2 * exp(-3.0 * dot(offset, offset));
}
