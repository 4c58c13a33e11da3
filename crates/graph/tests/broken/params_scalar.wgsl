var<uniform> params: vec4<f32>;

@fragment fn fragment(@builtin(position) position: vec4<f32>) -> @location(0) f32 {
    return params.x;
}
