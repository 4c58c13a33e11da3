struct Params { bias: u32, edge: u32 }
var<uniform> params: Params;

@fragment fn fragment(@builtin(position) position: vec4<f32>) -> @location(0) f32 {
    return f32(params.bias + params.edge);
}
