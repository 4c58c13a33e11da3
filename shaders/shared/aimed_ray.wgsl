// Rays to points of a light that is an area.

#import "shared/light_area.wgsl"
#import "shared/ray.wgsl"

// The ray to a point of the unit disk, of one that goes to the light's centre.
fn aimed(asked: Ray, point: vec2<f32>) -> Ray {
    // To the bit the ray that is asked: the answer of a light without extent is the tracer's.
    if light_area.radius == 0.0 {
        return asked;
    }
    let across = across_light(point, asked.direction);
    if light_kind == LIGHT_DIRECTIONAL {
        return Ray(asked.origin, asked.t_min, asked.direction + across, asked.t_max);
    }
    let way = light_way(asked.origin) + across;
    let distance = length(way);
    return Ray(asked.origin, asked.t_min, way / distance, distance * (1.0 - LIGHT_GAP));
}
