// Stage to find the receiver of each pixel: its position, and dot(n, l) of its interpolated normal
// in w, 0 outside of a spot light's cone; one thread per pixel. The ray through the pixel's centre
// is met with the plane of the pixel's primitive anew instead of interpolating rasterised
// attributes, whose precision is the adapter's affair: the edge functions of Davidovic et al., "3D
// Rasterization", TUGraz 2012.

#import "shared/camera.wgsl"
#import "shared/light.wgsl"
#import "shared/geometry.wgsl"
#import "shared/ids.wgsl"

var<storage, read> scene_normals: array<vec4<f32>>;
var<storage, read> scene_normal_indices: array<u32>;
var primitive: texture_2d<u32>;
var position: texture_storage_2d<rgba32float, write>;

// Twice dot(direction, p x q). Sum and difference first: the product of two long, nearly equal
// vectors would cancel.
fn edge(direction: vec3<f32>, p: vec3<f32>, q: vec3<f32>) -> f32 {
    return dot(direction, cross(p + q, q - p));
}

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
    let edges = vec3(edge(direction, b, c), edge(direction, c, a), edge(direction, a, b));
    let sum = edges.x + edges.y + edges.z;
    // Not clamped to the triangle: rasterisers snap corners, so a pixel's centre may lie a hair
    // outside its primitive. A primitive seen exactly edge-on has no such point; its centroid
    // stands in.
    var weights = vec3(1.0 / 3.0);
    if sum != 0.0 {
        weights = edges / sum;
    }

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
    let normal = weights.x * corner_normal(3u * id)
        + weights.y * corner_normal(3u * id + 1u)
        + weights.z * corner_normal(3u * id + 2u);
    let length_squared = dot(normal, normal);
    var n_dot_l = 0.0;
    if length_squared > 0.0 && light_shines_on(receiver) {
        n_dot_l = dot(normal, to_light_from(receiver)) * inverseSqrt(length_squared);
    }
    textureStore(position, pixel, vec4(receiver, n_dot_l));
}

fn corner_normal(corner: u32) -> vec3<f32> {
    return scene_normals[scene_normal_indices[corner]].xyz;
}
