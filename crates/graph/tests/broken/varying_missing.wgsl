struct Out { @builtin(position) at: vec4f, @location(0) near: f32 }
@vertex fn vertex() -> Out { return Out(); }
@fragment fn fragment(@location(1) far: f32) -> @location(0) f32 { return far; }
