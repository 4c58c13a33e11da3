struct Params { gain: f32, shift: f32 }
var<uniform> params: Params;
@fragment fn fragment() -> @location(0) f32 {
    return params.gain;
}
