// Rays to points of a light that is an area.

#import "shared/light_area.wgsl"
#import "shared/ray.wgsl"

// The ray from a receiver to a point of the unit disk.
fn sample_ray(receiver: vec3<f32>, t_min: f32, point: vec2<f32>) -> Ray {
    let centre = Ray(receiver, t_min, to_light_from(receiver), light_distance(receiver));
    return aimed(centre, point);
}

// The ray to a point of the unit disk, of one that goes to the light's centre.
fn aimed(asked: Ray, point: vec2<f32>) -> Ray {
    let across = across_light(point, asked.direction);
    // To the bit the ray that is asked: the answer of a light without extent is the tracer's. Not a
    // branch: llvmpipe would compile shaders anew in each frame for one that a uniform decides.
    let is_point = light_area.radius == 0.0;
    if light_kind == LIGHT_DIRECTIONAL {
        let direction = select(asked.direction + across, asked.direction, is_point);
        return Ray(asked.origin, asked.t_min, direction, asked.t_max);
    }
    let way = light_way(asked.origin) + across;
    let distance = length(way);
    let direction = select(way / distance, asked.direction, is_point);
    let t_max = select(distance * (1.0 - LIGHT_GAP), asked.t_max, is_point);
    return Ray(asked.origin, asked.t_min, direction, t_max);
}
