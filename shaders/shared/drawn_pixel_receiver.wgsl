// In the place of shared/pixel_receiver.wgsl: the receiver of a pixel is found anew.

#import "shared/all_roles.wgsl"
#import "shared/drawn_receiver.wgsl"
#import "shared/facing.wgsl"
#import "shared/light.wgsl"

// dot(n, l) is 0 outside of a spot light's cone, UNSHADOWED where the primitive receives no shadow;
// all is 0 without a primitive.
fn pixel_receiver(pixel: vec2<u32>) -> vec4<f32> {
    let id = textureLoad(primitive, pixel, 0).x;
    if id == NO_PRIMITIVE {
        return vec4(0.0);
    }
    let at = drawn_receiver(pixel, textureDimensions(primitive), id);
    let normal = interpolated_normal(at, id);
    let length_squared = dot(normal, normal);
    var n_dot_l = 0.0;
    if length_squared > 0.0 && light_shines_on(at.place) {
        n_dot_l = dot(normal, to_light_from(at.place)) * inverseSqrt(length_squared);
    }
    return vec4(at.place, select(UNSHADOWED, n_dot_l, receives_shadow(id)));
}

fn receiver_place(pixel: vec2<u32>, id: u32) -> vec3<f32> {
    return drawn_receiver(pixel, textureDimensions(primitive), id).place;
}
