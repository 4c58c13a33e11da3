#import "shear.wgsl"
#import "shared/receiver.wgsl"

var map: texture_depth_2d;

@fragment
fn fragment(@builtin(position) centre: vec4<f32>) -> @location(0) u32 {
    let receiver = textureLoad(position, vec2<u32>(centre.xy), 0);
    if !faces_light(receiver) {
        return 0u;
    }
    let texel = sheared_texel(receiver.xyz);
    return select(0u, 1u, is_outside(texel.xy) || texel.z <= textureLoad(map, vec2<u32>(texel.xy), 0));
}
