// Receivers that look up a map from before their surface. Holbert, "Saying Goodbye to Shadow Acne",
// GDC 2011.

#import "shared/camera.wgsl"
#import "shared/depth_bias.wgsl"
#import "shared/geometry.wgsl"
#import "shared/receiver.wgsl"

// Texels of the map, where the light grazes the surface.
override normal_offset: f32;

// Along the normal of the pixel's primitive, towards the eye; the less, the steeper the light. Not
// where the primitive is not known.
fn moved(fit: MapFit, pixel: vec2<u32>, receiver: vec3<f32>) -> vec3<f32> {
    let id = textureLoad(primitive, pixel, 0).x;
    if id >= arrayLength(&scene_indices) / 3u {
        return receiver;
    }
    let a = corner_position(3u * id);
    let across = cross(corner_position(3u * id + 1u) - a, corner_position(3u * id + 2u) - a);
    let normal = across * inverseSqrt(max(dot(across, across), 1e-37));
    let side = sign(dot(normal, -relative_to_eye(receiver)));
    let slope = length(cross(normal, to_light_from(receiver)));
    let texel = texel_edge_at(fit, receiver, texel_of(fit, receiver));
    return receiver + normal_offset * texel * slope * side * normal;
}
