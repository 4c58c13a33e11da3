fn brightness(at: vec2<f32>, scale: f32) -> f32 {
    return at.x * scale;
}
