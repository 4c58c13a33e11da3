struct Params { mode: u32 }
var<uniform> params: Params;

@fragment fn fragment() -> @location(0) f32 {
    return select(0.5, 1.0, params.mode == MODE_EXCAT || params.mode == MODE_FAST);
}
