var<storage, read> uvs: array<vec2<f32>>;
var albedo: texture_2d<f32>;
@fragment fn fragment(@builtin(position) p: vec4<f32>) -> @location(0) f32 { return uvs[0].x + textureLoad(albedo, vec2<u32>(0), 0).x; }
