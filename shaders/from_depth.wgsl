// Stage to find the receiver of each pixel from a host's depth and normals; one thread per pixel.
// The receiver's primitive is not known, so it is put before its surface instead: nearer to the eye
// by the error of its depth, and along its normal by what the rasteriser has moved the surface, and
// by the error of the arithmetic here (docs/embedding.md). A surface does not shade itself then.

#import "shared/light.wgsl"
#import "shared/ids.wgsl"
#import "shared/predicates.wgsl"
#import "shared/unprojection.wgsl"

struct Params {
    unsigned: u32,
    depth_steps: f32,
    snapping: f32,
}

var<uniform> params: Params;
var depth: texture_depth_2d;
var normal: texture_2d<f32>;
var primitive: texture_storage_2d<r32uint, write>;
var position: texture_storage_2d<rgba32float, write>;

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) thread: vec3<u32>) {
    let pixel = thread.xy;
    let viewport = textureDimensions(depth);
    if any(pixel >= viewport) {
        return;
    }
    let seen = textureLoad(depth, pixel, 0);
    if seen == farthest_depth() {
        textureStore(primitive, pixel, vec4(NO_PRIMITIVE));
        textureStore(position, pixel, vec4(0.0));
        return;
    }
    // As much again for the arithmetic here.
    let nearer = nearer_depth(seen, 2.0 * HALF_ULP * params.depth_steps * abs(seen));
    let relative = relative_at_depth(pixel, viewport, nearer);
    let place = (relative + unprojection.origin_low) + unprojection.origin;
    let beside = relative_at_depth(pixel + vec2(1u, 0u), viewport, nearer);
    let below = relative_at_depth(pixel + vec2(0u, 1u), viewport, nearer);
    let pixel_size = distance(relative, beside) + distance(relative, below);

    var away = textureLoad(normal, pixel, 0).xyz;
    if params.unsigned != 0u {
        away = 2.0 * away - 1.0;
    }
    let length_squared = dot(away, away);
    away *= inverseSqrt(max(length_squared, 1e-37));
    // A plane through corners that were moved sideways by a share of a pixel is no farther from the
    // right one than that, however steep it is. Normals may be 45 degrees off the plane's.
    let rounding = 4.0 * HALF_ULP * (length(place) + 2.0 * length(relative));
    let receiver = place + (params.snapping * pixel_size + rounding) * away;
    var n_dot_l = 0.0;
    if length_squared > 0.0 && light_shines_on(receiver) {
        n_dot_l = dot(away, to_light_from(receiver));
    }
    textureStore(primitive, pixel, vec4(UNKNOWN_PRIMITIVE));
    textureStore(position, pixel, vec4(receiver, n_dot_l));
}
