@fragment fn fragment(@location(0) uv: vec2f) -> @location(0) f32 { return uv.x; }
