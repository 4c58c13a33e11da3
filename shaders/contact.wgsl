// Stage to march from each pixel that faces the light towards it, through what the eye sees; a
// full-screen triangle over a method's answer. Screen-space contact shadows, as engines have them
// (Unreal Engine 4.14, 2016); the march, a ray's depths within a pixel and the thickness are of
// McGuire, Mara, "Efficient GPU Screen-Space Ray Tracing", JCGT 3(4), 2014, sections 3 and 4.

#import "shared/camera.wgsl"
#import "shared/light.wgsl"
#import "shared/ray_triangle.wgsl"
#import "shared/receiver.wgsl"

struct Params {
    reach: f32,
    steps: u32,
    thickness: f32,
    caster: u32,
}

var<uniform> params: Params;

// Over a method that answers lit or in shadow.
@fragment
fn hard(@builtin(position) centre: vec4<f32>) -> @location(0) u32 {
    leave_unless_in_contact(vec2<u32>(centre.xy));
    return 0u;
}

// Over one that answers with a share of the light.
@fragment
fn graded(@builtin(position) centre: vec4<f32>) -> @location(0) f32 {
    leave_unless_in_contact(vec2<u32>(centre.xy));
    return 0.0;
}

fn leave_unless_in_contact(pixel: vec2<u32>) {
    let receiver = textureLoad(position, pixel, 0);
    if initial_status(pixel, receiver) != STATUS_UNCERTAIN || !is_in_contact(pixel, receiver.xyz) {
        discard;
    }
}

fn is_in_contact(pixel: vec2<u32>, receiver: vec3<f32>) -> bool {
    let size = vec2<f32>(textureDimensions(position));
    let start = relative_to_eye(receiver);
    let distance = dot(start, camera.forward);
    let direction = to_light_from(receiver);
    // Ends before the near plane, and at the light.
    let sinking = max(-dot(direction, camera.forward), 1e-6);
    let reach = min(params.reach * distance, light_distance(receiver));
    let end = min(reach, 0.99 * (distance - camera.near) / sinking);
    let places = array(camera_clip(start), camera_clip(start + end * direction));
    // Pixels, and 1 / distance, which is linear along them.
    let first = vec3(to_pixels(places[0], size), 1.0 / places[0].w);
    let way = vec3(to_pixels(places[1], size), 1.0 / places[1].w) - first;
    let pixels = max(abs(way.x), abs(way.y));
    let steps = min(ceil(pixels), f32(params.steps));
    // Interleaved gradient noise: Jimenez, "Next Generation Post Processing", SIGGRAPH 2014.
    let noise = fract(52.9829189 * fract(dot(vec2<f32>(pixel), vec2(0.06711056, 0.00583715))));
    let own = textureLoad(primitive, pixel, 0).x;
    let ray = sheared(Ray(receiver, 0.0, direction, light_distance(receiver)));
    let tolerance = 2.0 * camera.half_height / size.y * distance;
    for (var i = 0.0; i < steps; i += 1.0) {
        let along = (i + noise) / steps;
        let at = first + along * way;
        if any(at.xy < vec2(0.0)) || any(at.xy >= size) {
            return false;
        }
        let id = textureLoad(primitive, vec2<u32>(at.xy), 0).x;
        if id == own || id == NO_PRIMITIVE {
            continue;
        }
        if params.caster == CASTER_TRIANGLE {
            var hit = Hit(light_distance(receiver), NO_PRIMITIVE, 0.0, 0.0);
            if intersect(ray, id, 0.0, &hit) {
                return true;
            }
            continue;
        }
        let seen = textureLoad(position, vec2<u32>(at.xy), 0).xyz;
        let behind = 1.0 / at.z - dot(relative_to_eye(seen), camera.forward);
        if behind > tolerance && behind < params.thickness * distance {
            return true;
        }
    }
    return false;
}

fn to_pixels(clip: vec4<f32>, size: vec2<f32>) -> vec2<f32> {
    return (clip.xy / clip.w * vec2(0.5, -0.5) + 0.5) * size;
}
