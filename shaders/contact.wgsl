// Stage to march from each pixel that faces the light towards it, through what the eye sees; a
// full-screen triangle over a method's answer. Screen-space contact shadows, as engines have them
// (Unreal Engine 4.14, 2016). The thickness is that of McGuire, Mara, "Efficient GPU Screen-Space
// Ray Tracing", JCGT 3(4), 2014, section 4.

#import "shared/camera.wgsl"
#import "shared/ids.wgsl"
#import "shared/light.wgsl"
#import "shared/ray_triangle.wgsl"
#import "shared/receiver.wgsl"
#import "shared/all_roles.wgsl"

struct Params {
    reach: f32,
    steps: u32,
    thickness: f32,
}

var<uniform> params: Params;

// Over a method that answers lit or in shadow.
@fragment
fn hard(@builtin(position) centre: vec4<f32>) -> @location(0) u32 {
    leave_unless_stopped(vec2<u32>(centre.xy));
    return 0u;
}

// Over one that answers with a share of the light.
@fragment
fn graded(@builtin(position) centre: vec4<f32>) -> @location(0) f32 {
    leave_unless_stopped(vec2<u32>(centre.xy));
    return 0.0;
}

fn leave_unless_stopped(pixel: vec2<u32>) {
    let receiver = textureLoad(position, pixel, 0);
    let ray = Ray(receiver.xyz, 0.0, to_light_from(receiver.xyz), light_distance(receiver.xyz));
    let start = relative_to_eye(receiver.xyz);
    let distance = dot(start, camera.forward);
    let step = ray.direction * min(params.reach * distance, ray.t_max) / f32(params.steps);
    let size = vec2<f32>(textureDimensions(position));
    // The height of a pixel there: a surface may rise by as much from one to the next.
    let rise = 2.0 * camera.half_height / size.y * distance;
    let own = textureLoad(primitive, pixel, 0).x;
    let begin = receiver_error_bound(receiver.xyz, camera.eye);
    let steps = select(0u, params.steps, initial_status(pixel, receiver) == STATUS_UNCERTAIN);
    // Interleaved gradient noise: Jimenez, "Next Generation Post Processing", SIGGRAPH 2014.
    let noise = fract(52.9829189 * fract(dot(vec2<f32>(pixel), vec2(0.06711056, 0.00583715))));
    for (var i = 0u; i < steps; i++) {
        let clip = camera_clip(start + step * (f32(i) + noise));
        if any(abs(clip.xy) >= vec2(clip.w)) {
            break;
        }
        let at = vec2<u32>(min((clip.xy / clip.w * vec2(0.5, -0.5) + 0.5) * size, size - 1.0));
        let id = textureLoad(primitive, at, 0).x;
        let seen = dot(relative_to_eye(textureLoad(position, at, 0).xyz), camera.forward);
        var hit = Hit(ray.t_max, id, 0.0, 0.0);
        let is_known = id != UNKNOWN_PRIMITIVE;
        if id == NO_PRIMITIVE || (is_known && (id == own || !casts_shadow(id))) {
            continue;
        }
        if (clip.w - seen > rise && clip.w - seen < params.thickness * distance)
            || (params.thickness == 0.0 && is_known && intersect(sheared(ray), id, begin, &hit)) {
            return;
        }
    }
    discard;
}
