#import "shared/frame.wgsl"
@fragment fn fragment(@builtin(position) p: vec4<f32>) -> @location(0) f32 { return f32(frame.index); }
