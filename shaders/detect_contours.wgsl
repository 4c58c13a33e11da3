// Stage to compare each pixel's depth in light space with the texels of the shadow map around it;
// one thread per pixel. All agree: certain. Otherwise, and outside the map: uncertain. Beister,
// Ernst, Stamminger, "A Hybrid GPU-CPU Renderer", 2005.

#import "shared/footprint.wgsl"
#import "shared/map_layers.wgsl"
#import "shared/receiver.wgsl"

struct Params {
    bias: f32,
    footprint: u32,
}

var<uniform> params: Params;
var shadow_maps: texture_depth_2d_array;
var visibility: texture_storage_2d<r32uint, write>;
var status: texture_storage_2d<r32uint, write>;

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) thread: vec3<u32>) {
    let pixel = thread.xy;
    if any(pixel >= textureDimensions(primitive)) {
        return;
    }
    let receiver = textureLoad(position, pixel, 0);
    var pixel_status = initial_status(pixel, receiver);
    if pixel_status == STATUS_UNCERTAIN {
        pixel_status = compare(receiver.xyz);
    }
    textureStore(status, pixel, vec4(pixel_status));
    textureStore(visibility, pixel, vec4(initial_visibility(pixel_status)));
}

fn compare(receiver: vec3<f32>) -> u32 {
    let layer = layer_of(receiver);
    let fit = fit_of(layer);
    let place = texel_of(fit, receiver);
    if is_outside_of(fit, place.xy) {
        return STATUS_UNCERTAIN;
    }
    let asked = footprint(fit, place.xy, params.footprint);
    var lit = true;
    var shadowed = true;
    for (var y = asked.first.y; y <= asked.last.y; y += asked.step) {
        for (var x = asked.first.x; x <= asked.last.x; x += asked.step) {
            let stored = textureLoad(shadow_maps, vec2(x, y), layer, 0);
            // 1 is what the map was cleared to: no caster, however far.
            let is_lit = stored >= 1.0 || place.z <= stored + params.bias;
            lit &= is_lit;
            shadowed &= !is_lit;
        }
    }
    return select(select(STATUS_UNCERTAIN, STATUS_SHADOW, shadowed), STATUS_LIGHT, lit);
}
