fn first(items: ptr<function, array<f32>>) -> f32 {
    return 1.0;
}

@fragment fn fragment() -> @location(0) f32 {
    return 1.0;
}
