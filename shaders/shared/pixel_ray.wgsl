// The shadow ray of a pixel.

#import "shared/camera.wgsl"
#import "shared/facing.wgsl"
#import "shared/light.wgsl"
#import "shared/pixel_receiver.wgsl"
#import "shared/predicates.wgsl"
#import "shared/ray.wgsl"
#import "shared/ray_end.wgsl"

fn pixel_ray(pixel: vec2<u32>) -> AskedRay {
    let id = textureLoad(primitive, pixel, 0).x;
    // The background has no receiver: its ray is empty.
    if id == NO_PRIMITIVE {
        return AskedRay(Ray(vec3(0.0), 0.0, vec3(0.0), -1.0), id);
    }
    let receiver = receiver_place(pixel, id);
    let t_min = receiver_error_bound(receiver, camera.eye);
    let ray = Ray(receiver, t_min, to_light_from(receiver), light_distance(receiver));
    return AskedRay(Ray(ray.origin, ray.t_min, ray.direction, ray_end(ray)), id);
}
