// Stage to write a gradient.
@fragment fn fragment(@builtin(position) position: vec4<f32>) -> @location(0) f32 {
    return position.x;
}
