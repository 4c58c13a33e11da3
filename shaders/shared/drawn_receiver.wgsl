// The receiver of a pixel, found from the primitive that was drawn there. The ray through the
// pixel's centre is met with the primitive anew instead of interpolating rasterised attributes,
// whose precision is the adapter's affair, and stays within it: the edge functions of Davidovic et
// al., "3D Rasterization", TUGraz 2012.

#import "shared/camera.wgsl"
#import "shared/geometry.wgsl"
#import "shared/pixel_weights.wgsl"
#import "shared/solid.wgsl"

var<storage, read> scene_normals: array<vec4<f32>>;
var<storage, read> scene_normal_indices: array<u32>;

struct DrawnReceiver {
    place: vec3<f32>,
    // Weights of the primitive's corners.
    weights: vec3<f32>,
    from_behind: bool,
}

fn drawn_receiver(pixel: vec2<u32>, viewport: vec2<u32>, id: u32) -> DrawnReceiver {
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

// Returns the interpolated normal, of any length: of a double-sided primitive for the side that is
// seen.
fn interpolated_normal(at: DrawnReceiver, id: u32) -> vec3<f32> {
    let normal = at.weights.x * corner_normal(3u * id)
        + at.weights.y * corner_normal(3u * id + 1u)
        + at.weights.z * corner_normal(3u * id + 2u);
    return select(normal, -normal, at.from_behind && is_double_sided(id));
}

fn corner_normal(corner: u32) -> vec3<f32> {
    return scene_normals[scene_normal_indices[corner]].xyz;
}
