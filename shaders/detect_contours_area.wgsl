// Stage to compare each pixel's depth in eight light spaces, of the light's centre and of seven
// points of its rim, with the texels of their shadow maps around it; one thread per pixel. All
// agree: certain. Otherwise, and outside a map: uncertain. Beister, Ernst, Stamminger, "A Hybrid
// GPU-CPU Renderer", 2005.

#import "shared/answer_shares.wgsl" instead "shared/answer.wgsl"
#import "shared/classify.wgsl"
#import "shared/footprint.wgsl"
#import "shared/area_lights.wgsl"

struct Params {
    bias: f32,
    footprint: u32,
}

var<uniform> params: Params;
var<storage, read> area_lights: array<LightSlot>;
var maps: texture_depth_2d_array;

fn compare(receiver: vec3<f32>) -> u32 {
    var lit = true;
    var shadowed = true;
    for (var point = 0u; point < arrayLength(&area_lights); point++) {
        let relative = vec4(receiver - light.centre.xyz, 1.0);
        let place = texel_of_clip(
            map_fit,
            (area_lights[point].light.clip_from_relative * relative).xyz,
        );
        if is_outside(place.xy) {
            return STATUS_UNCERTAIN;
        }
        let asked = footprint(map_fit, place.xy, params.footprint);
        let taps = taps(maps, point, asked, place.z, params.bias);
        lit &= taps.lit;
        shadowed &= taps.shadowed;
        if !lit && !shadowed {
            return STATUS_UNCERTAIN;
        }
    }
    return select(STATUS_SHADOW, STATUS_LIGHT, lit);
}
