struct Out { @location(0) first: f32, @location(8) last: f32 }
@fragment fn fragment() -> Out { return Out(1.0, 2.0); }
