struct Outputs {
    @location(0) a: vec4<f32>,
    @location(1) b: vec4<f32>,
    @location(2) c: vec4<f32>,
}

@fragment fn fragment() -> Outputs {
    return Outputs(vec4<f32>(0.0), vec4<f32>(0.0), vec4<f32>(0.0));
}
