struct Params { rotation: mat4x4<f32> }
var<uniform> params: Params;

@fragment fn fragment() -> @location(0) f32 {
    return params.rotation[0].x;
}
