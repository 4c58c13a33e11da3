// Stage to compare each pixel's depth in light space with the outer and the inner depth of the map;
// one thread per pixel. Both say light, or both shadow, in each texel asked: certain. Otherwise,
// and outside the map: uncertain. Hertel, Hormann, Westermann 2009.

#import "shared/classify.wgsl"
#import "shared/predicates.wgsl"
#import "shared/footprint.wgsl"
#import "shared/map_layers.wgsl"

struct Params {
    footprint: u32,
}

var<uniform> params: Params;
var outer: texture_depth_2d_array;
var inner: texture_depth_2d_array;

fn compare(receiver: vec3<f32>) -> u32 {
    let layer = layer_of(receiver);
    let fit = fit_of(layer);
    let place = texel_of(fit, receiver);
    var error = texel_error_bound_of(fit, receiver);
    if light_kind != LIGHT_DIRECTIONAL {
        // Half of the slack; the other half is the corners'.
        error.x = 2.0 * spot_texel_error(fit, receiver);
    }
    // A receiver that may lie in another texel than it seems, even one grown by the slack, is not
    // compared.
    if is_outside_of(fit, place.xy) || !(error.x <= SLACK) {
        return STATUS_UNCERTAIN;
    }
    let far = place.z + error.y;
    let near = place.z - error.y;
    let asked = footprint(fit, place.xy, params.footprint);
    var lit = true;
    var shadowed = true;
    for (var y = asked.first.y; y <= asked.last.y; y += asked.step) {
        for (var x = asked.first.x; x <= asked.last.x; x += asked.step) {
            let in_outer = textureLoad(outer, vec2(x, y), layer, 0);
            let in_inner = textureLoad(inner, vec2(x, y), layer, 0);
            // 1 is what both were cleared to: no caster, however far.
            lit &= (in_outer >= 1.0 || far <= in_outer) && (in_inner >= 1.0 || far <= in_inner);
            shadowed &= in_outer < 1.0 && near > in_outer && in_inner < 1.0 && near > in_inner;
        }
    }
    if params.footprint == FOOTPRINT_CORNERS {
        // The dissertation's fifth tap of both layers reads the outer one, at the place itself.
        let in_outer = textureLoad(outer, vec2<u32>(place.xy), layer, 0);
        lit &= in_outer >= 1.0 || far <= in_outer;
        shadowed &= in_outer < 1.0 && near > in_outer;
    }
    return select(select(STATUS_UNCERTAIN, STATUS_SHADOW, shadowed), STATUS_LIGHT, lit);
}
