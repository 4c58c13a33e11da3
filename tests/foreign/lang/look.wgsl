var noise: texture_2d<f32>;
@fragment fn fragment(@builtin(position) p: vec4<f32>) -> @location(0) f32 { return textureLoad(noise, vec2<u32>(p.xy) % textureDimensions(noise), 0).x; }
