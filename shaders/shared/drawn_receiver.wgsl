// In the place of shared/pixel_receiver.wgsl: the receiver of a pixel, found from the primitive
// that was drawn there. The ray through the pixel's centre is met with the primitive anew instead
// of interpolating rasterised attributes, whose precision is the adapter's affair, and stays within
// it: the edge functions of Davidovic et al., "3D Rasterization", TUGraz 2012.

#import "shared/camera.wgsl"
#import "shared/facing.wgsl"
#import "shared/geometry.wgsl"
#import "shared/light.wgsl"
#import "shared/pixel_weights.wgsl"
#import "shared/solid.wgsl"

var<storage, read> scene_normals: array<vec4<f32>>;
var<storage, read> scene_normal_indices: array<u32>;

struct DrawnReceiver {
    place: vec3<f32>,
    // Of the primitive's corners.
    weights: vec3<f32>,
    from_behind: bool,
}

fn drawn_receiver(pixel: vec2<u32>, id: u32) -> DrawnReceiver {
    let viewport = textureDimensions(primitive);
    let world = corner_position(3u * id);
    let a = relative_to_eye(world);
    let b = relative_to_eye(corner_position(3u * id + 1u));
    let c = relative_to_eye(corner_position(3u * id + 2u));
    let at = receiver_weights(pixel_direction(pixel, viewport), viewport, a, b, c);
    let weights = at.weights;

    // From a corner along the edges, so that the point stays in the primitive's plane whatever the
    // weights' error; from the one that weighs most, so that one that is far off adds no more of
    // its rounding than its weight.
    let most = max(weights.x, max(weights.y, weights.z));
    var place = world + (weights.y * (b - a) + weights.z * (c - a));
    if weights.y == most {
        place = corner_position(3u * id + 1u) + (weights.z * (c - b) + weights.x * (a - b));
    } else if weights.z == most {
        place = corner_position(3u * id + 2u) + (weights.x * (a - c) + weights.y * (b - c));
    }
    return DrawnReceiver(place, weights, at.from_behind);
}

fn receiver_place(pixel: vec2<u32>, id: u32) -> vec3<f32> {
    return drawn_receiver(pixel, id).place;
}

// dot(n, l) is of the interpolated normal; 0 outside of a spot light's cone. All 0 without a
// primitive.
fn pixel_receiver(pixel: vec2<u32>) -> vec4<f32> {
    let id = textureLoad(primitive, pixel, 0).x;
    if id == NO_PRIMITIVE {
        return vec4(0.0);
    }
    let at = drawn_receiver(pixel, id);
    var normal = at.weights.x * corner_normal(3u * id)
        + at.weights.y * corner_normal(3u * id + 1u)
        + at.weights.z * corner_normal(3u * id + 2u);
    if at.from_behind && is_double_sided(id) {
        normal = -normal;
    }
    let length_squared = dot(normal, normal);
    var n_dot_l = 0.0;
    if length_squared > 0.0 && light_shines_on(at.place) {
        n_dot_l = dot(normal, to_light_from(at.place)) * inverseSqrt(length_squared);
    }
    return vec4(at.place, n_dot_l);
}

fn corner_normal(corner: u32) -> vec3<f32> {
    return scene_normals[scene_normal_indices[corner]].xyz;
}
