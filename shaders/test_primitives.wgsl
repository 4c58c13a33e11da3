// Stage to test each ray against one triangle, the one that the outer depth comes from in its
// texel: a miss is taken for light. One thread per ray. Hertel, Hormann, Westermann 2009 begin with
// it; the dissertation's section 5.4.1 leaves it out because of its errors.

#import "shared/map_layers.wgsl"
#import "shared/ray_triangle.wgsl"
#import "shared/trace_entries.wgsl"

var outer_primitive: texture_2d_array<u32>;

fn trace(ray: Ray, skipped: u32, first_found: bool) -> Hit {
    let layer = layer_of(ray.origin);
    let fit = fit_of(layer);
    let place = texel_of(fit, ray.origin);
    var candidate = NO_PRIMITIVE;
    if !is_outside_of(fit, place.xy) {
        candidate = textureLoad(outer_primitive, vec2<u32>(place.xy), layer, 0).x;
    }
    var hit = Hit(ray.t_max, NO_PRIMITIVE, 0.0, 0.0);
    if candidate != NO_PRIMITIVE && candidate != skipped {
        intersect(sheared(ray), candidate, ray.t_min, &hit);
    }
    return hit;
}
