@vertex fn vertex(@location(0) position: vec4f) -> @builtin(position) vec4f { return position; }
@fragment fn fragment() -> @location(0) f32 { return 1.0; }
