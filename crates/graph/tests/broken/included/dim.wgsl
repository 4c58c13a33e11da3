fn brightness(at: vec2<f32>) -> f32 {
    return 0.5 * at.x;
}
