// Where a shadow ray ends: at the light. shared/ray_end_in_map.wgsl ends it sooner.

#import "shared/ray.wgsl"

fn ray_end(ray: Ray) -> f32 {
    return ray.t_max;
}
