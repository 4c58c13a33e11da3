struct Out { @builtin(position) at: vec4f, @location(16) far: f32 }
@vertex fn vertex() -> Out { return Out(); }
@fragment fn fragment(in: Out) -> @location(0) f32 { return in.far; }
