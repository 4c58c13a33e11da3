// Stage to draw rings around the centre, one thread per texel.
struct Params { width: f32 }
var<uniform> params: Params;
var rings: texture_storage_2d<r32float, write>;

@compute @workgroup_size(8, 8) fn main(@builtin(global_invocation_id) texel: vec3<u32>) {
    let size = textureDimensions(rings);
    if any(texel.xy >= size) { return; }
    // Terminal cells are twice as high as wide.
    let offset = (vec2<f32>(texel.xy) + 0.5 - vec2<f32>(size) * 0.5) * vec2(0.5, 1.0);
    let ring = u32(length(offset) / params.width);
    textureStore(rings, texel.xy, vec4(f32(ring % 2u), 0.0, 0.0, 0.0));
}
