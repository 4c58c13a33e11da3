struct Table { entries: array<vec4<f32>, 8192> }
var<uniform> table: Table;

@fragment fn fragment() -> @location(0) f32 {
    return table.entries[3].x;
}
