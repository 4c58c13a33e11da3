struct Params { count: u32 }
var<uniform> params: Params;

@fragment fn fragment() -> @location(0) f32 {
    return f32(params.count);
}
