// In the place of shared/ray_end.wgsl: a ray ends at the nearest depth of anything in its texel of
// the map: nothing is left to hit between there and the light. Hertel, Hormann, Westermann 2009
// start their traversal at that depth.

#import "shared/map_layers.wgsl"
#import "shared/predicates.wgsl"
#import "shared/ray.wgsl"

var nearest: texture_depth_2d_array;

fn ray_end(ray: Ray) -> f32 {
    let layer = layer_of(ray.origin);
    let fit = fit_of(layer);
    let place = texel_of(fit, ray.origin);
    let error = texel_error_bound_of(fit, ray.origin);
    // A ray whose origin may lie in another texel than it seems is not clipped.
    if is_outside_of(fit, place.xy) || error.x > SLACK {
        return ray.t_max;
    }
    let stored = textureLoad(nearest, vec2<u32>(place.xy), layer, 0);
    // 0 may stand for something before the near plane, however near to the light.
    if stored <= 0.0 {
        return ray.t_max;
    }
    // Units of the scene, with room for the rounding of depths and for that of the distance at
    // which the tracer meets a triangle: 8 half ulps of the longest way there is. An empty texel
    // holds 1, behind the receiver.
    let way = (place.z - stored + error.y) * light.extent.z + 8.0 * HALF_ULP * light.max_distance;
    return min(ray.t_max, way);
}
