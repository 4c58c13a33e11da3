// Stage to write the interpolated normal of what each pixel shows, of unit length, with 1 in w; 0
// where there is none. One thread per pixel.

#import "shared/drawn_receiver.wgsl"
#import "shared/ids.wgsl"

var primitive: texture_2d<u32>;
var shading_normal: texture_storage_2d<rgba16float, write>;

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) thread: vec3<u32>) {
    let viewport = textureDimensions(primitive);
    if any(thread.xy >= viewport) {
        return;
    }
    let id = textureLoad(primitive, thread.xy, 0).x;
    var normal = vec3(0.0);
    if id != NO_PRIMITIVE {
        normal = interpolated_normal(drawn_receiver(thread.xy, viewport, id), id);
    }
    let length_squared = dot(normal, normal);
    let scale = select(0.0, inverseSqrt(length_squared), length_squared > 0.0);
    textureStore(shading_normal, thread.xy, vec4(normal * scale, sign(scale)));
}
