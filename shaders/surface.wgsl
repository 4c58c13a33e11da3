// Stage to find the receiver of each pixel: its position, and dot(n, l) of its interpolated normal
// in w, 0 outside of a spot light's cone, UNSHADOWED where it receives no shadow; one thread per
// pixel. The ray through the pixel's centre
// is met with the pixel's primitive anew instead of interpolating rasterised attributes, whose
// precision is the adapter's affair, and stays within it: the edge functions of Davidovic et al.,
// "3D Rasterization", TUGraz 2012.

#import "shared/camera.wgsl"
#import "shared/light.wgsl"
#import "shared/geometry.wgsl"
#import "shared/ids.wgsl"
#import "shared/pixel_weights.wgsl"
#import "shared/solid.wgsl"
#import "shared/all_roles.wgsl"

var<storage, read> scene_normals: array<vec4<f32>>;
var<storage, read> scene_normal_indices: array<u32>;
var primitive: texture_2d<u32>;
var position: texture_storage_2d<rgba32float, write>;

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) thread: vec3<u32>) {
    let pixel = thread.xy;
    let viewport = textureDimensions(primitive);
    if any(pixel >= viewport) {
        return;
    }
    let id = textureLoad(primitive, pixel, 0).x;
    if id == NO_PRIMITIVE {
        textureStore(position, pixel, vec4(0.0));
        return;
    }

    let direction = pixel_direction(pixel, viewport);
    let world = corner_position(3u * id);
    let a = relative_to_eye(world);
    let b = relative_to_eye(corner_position(3u * id + 1u));
    let c = relative_to_eye(corner_position(3u * id + 2u));
    let at = receiver_weights(direction, viewport, a, b, c);
    let weights = at.weights;

    // From a corner along the edges, so that the point stays in the primitive's plane whatever the
    // weights' error; from the one that weighs most, so that one that is far off adds no more of
    // its rounding than its weight.
    let most = max(weights.x, max(weights.y, weights.z));
    var receiver = world + (weights.y * (b - a) + weights.z * (c - a));
    if weights.y == most {
        receiver = corner_position(3u * id + 1u) + (weights.z * (c - b) + weights.x * (a - b));
    } else if weights.z == most {
        receiver = corner_position(3u * id + 2u) + (weights.x * (a - c) + weights.y * (b - c));
    }
    var normal = weights.x * corner_normal(3u * id)
        + weights.y * corner_normal(3u * id + 1u)
        + weights.z * corner_normal(3u * id + 2u);
    if at.from_behind && is_double_sided(id) {
        normal = -normal;
    }
    let length_squared = dot(normal, normal);
    var n_dot_l = 0.0;
    if length_squared > 0.0 && light_shines_on(receiver) {
        n_dot_l = dot(normal, to_light_from(receiver)) * inverseSqrt(length_squared);
    }
    let w = select(UNSHADOWED, n_dot_l, receives_shadow(id));
    textureStore(position, pixel, vec4(receiver, w));
}

fn corner_normal(corner: u32) -> vec3<f32> {
    return scene_normals[scene_normal_indices[corner]].xyz;
}
