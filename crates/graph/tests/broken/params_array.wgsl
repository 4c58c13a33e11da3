struct Params { weights: array<vec4<f32>, 2> }
var<uniform> params: Params;

@fragment fn fragment() -> @location(0) f32 {
    return params.weights[0].x;
}
