// Stage to write two gradients.
struct Gradients {
    @location(0) across: f32,
    @location(1) down: f32,
}

@fragment fn fragment(@builtin(position) position: vec4<f32>) -> Gradients {
    return Gradients(position.x, position.y);
}
