// Stage to test each ray against one triangle, the one that the outer depth comes from in its
// texel: a miss is taken for light. One thread per ray. Hertel, Hormann, Westermann 2009 begin with
// it; the dissertation's section 5.4.1 leaves it out because of its errors.

#import "shared/map_layers.wgsl"
#import "shared/groups.wgsl"
#import "shared/ray_triangle.wgsl"
#import "shared/ids.wgsl"

var outer_primitive: texture_2d_array<u32>;
var<storage, read> ray_count: u32;
var<storage, read> rays: array<Ray>;
var<storage, read> ray_primitives: array<u32>;
var<storage, read_write> hits: array<Hit>;

@compute @workgroup_size(GROUP_SIZE)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) lane: u32) {
    let slot = thread_number(group, lane);
    if slot >= ray_count {
        return;
    }
    let ray = rays[slot];
    let layer = layer_of(ray.origin);
    let fit = fit_of(layer);
    let place = texel_of(fit, ray.origin);
    var candidate = NO_PRIMITIVE;
    if !is_outside_of(fit, place.xy) {
        candidate = textureLoad(outer_primitive, vec2<u32>(place.xy), layer, 0).x;
    }
    var hit = Hit(ray.t_max, NO_PRIMITIVE, 0.0, 0.0);
    if candidate != NO_PRIMITIVE && candidate != ray_primitives[slot] {
        intersect(sheared(ray), candidate, ray.t_min, &hit);
    }
    hits[slot] = hit;
}
