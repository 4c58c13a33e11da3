struct Params { table: array<vec4<f32>, 8192> }
var<uniform> params: Params;

@fragment fn fragment() -> @location(0) f32 {
    return params.table[3].x;
}
