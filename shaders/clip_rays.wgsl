// Stage to clip each ray at the nearest depth of anything in its texel of the map: nothing is left
// to hit between there and the light. One thread per ray. Hertel, Hormann, Westermann 2009 start
// their traversal at that depth.

#import "shared/map_layers.wgsl"
#import "shared/predicates.wgsl"
#import "shared/groups.wgsl"
#import "shared/ray.wgsl"

var nearest: texture_depth_2d_array;
var<storage, read> ray_count: u32;
var<storage, read_write> rays: array<Ray>;

@compute @workgroup_size(GROUP_SIZE)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) lane: u32) {
    let slot = thread_number(group, lane);
    if slot >= ray_count {
        return;
    }
    let layer = layer_of(rays[slot].origin);
    let fit = fit_of(layer);
    let place = texel_of(fit, rays[slot].origin);
    let error = texel_error_bound_of(fit, rays[slot].origin);
    // A ray whose origin may lie in another texel than it seems is not clipped.
    if is_outside_of(fit, place.xy) || error.x > SLACK {
        return;
    }
    let stored = textureLoad(nearest, vec2<u32>(place.xy), layer, 0);
    // 0 may stand for something before the near plane, however near to the light.
    if stored <= 0.0 {
        return;
    }
    // Units of the scene, with room for the rounding of depths and for that of the distance at
    // which the tracer meets a triangle: 8 half ulps of the longest way there is. An empty texel
    // holds 1, behind the receiver.
    let way = (place.z - stored + error.y) * light.extent.z + 8.0 * HALF_ULP * light.max_distance;
    rays[slot].t_max = min(rays[slot].t_max, way);
}
