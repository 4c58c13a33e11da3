// Stage to compare each pixel of the host's G-buffer with the shadow map; a full-screen triangle.

struct Params { bias: f32 }
var<uniform> params: Params;
var<uniform> light: mat4x4<f32>;
var shadow_map: texture_depth_2d;
var depth: texture_depth_2d;
var position: texture_2d<f32>;

@fragment fn fragment(@builtin(position) centre: vec4<f32>) -> @location(0) f32 {
    let pixel = vec2<u32>(centre.xy);
    if textureLoad(depth, pixel, 0) == 1.0 {
        return 1.0; // background
    }
    let receiver = light * textureLoad(position, pixel, 0);
    let size = vec2<f32>(textureDimensions(shadow_map));
    let texel = vec2<u32>((receiver.xy * vec2(0.5, -0.5) + 0.5) * size);
    let occluder = textureLoad(shadow_map, texel, 0);
    return select(0.0, 1.0, receiver.z <= occluder + params.bias);
}
