struct Params { share: u32 }
var<uniform> params: Params;

@fragment fn fragment() -> @location(0) f32 {
    return 0.5 * params.share;
}
