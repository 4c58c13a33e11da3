// Stage to march from each pixel that faces the light towards it, in the depth buffer. A pixel that
// it finds in shadow is so, whatever a map says of it; all other pixels stay as they are.

#import "shared/camera.wgsl"
#import "shared/light.wgsl"
#import "shared/receiver.wgsl"
#import "vogel.wgsl"

struct Params { reach: f32, steps: u32, thickness: f32 }
var<uniform> params: Params;

// Over a method that answers lit or in shadow.
@fragment
fn hard(@builtin(position) centre: vec4<f32>) -> @location(0) u32 {
    leave_unless_in_contact(centre.xy);
    return 0u;
}

// Over one that answers with a share of the light.
@fragment
fn graded(@builtin(position) centre: vec4<f32>) -> @location(0) f32 {
    leave_unless_in_contact(centre.xy);
    return 0.0;
}

fn leave_unless_in_contact(centre: vec2<f32>) {
    let pixel = vec2<u32>(centre);
    let receiver = textureLoad(position, pixel, 0);
    if initial_status(pixel, receiver) != STATUS_UNCERTAIN || !is_in_contact(pixel, receiver.xyz) {
        discard;
    }
}

fn is_in_contact(pixel: vec2<u32>, receiver: vec3<f32>) -> bool {
    let start = relative_to_eye(receiver);
    let far = dot(start, camera.forward);
    let way = to_light_from(receiver) * params.reach * far;
    let size = vec2<f32>(textureDimensions(position));
    let jitter = gradient_noise(pixel);
    for (var i = 0u; i < params.steps; i++) {
        let along = start + way * ((f32(i) + jitter) / f32(params.steps));
        let clip = camera_clip(along);
        if any(abs(clip.xy) >= vec2(clip.w)) {
            break;
        }
        let at = vec2<u32>((clip.xy / clip.w * vec2(0.5, -0.5) + 0.5) * size);
        if all(at == pixel) || textureLoad(primitive, at, 0).x == NO_PRIMITIVE {
            continue;
        }
        let seen = dot(relative_to_eye(textureLoad(position, at, 0).xyz), camera.forward);
        let behind = clip.w - seen;
        // The seen surface's own slope over a pixel is no caster.
        if behind > 2.0 * camera.half_height / size.y * far && behind < params.thickness * far {
            return true;
        }
    }
    return false;
}
