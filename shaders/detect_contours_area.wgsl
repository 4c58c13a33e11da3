// Stage to compare each pixel's depth in eight light spaces, of the light's centre and of seven
// points of its rim, with the texels of their shadow maps around it; one thread per pixel. All
// agree: certain. Otherwise, and outside a map: uncertain. Beister, Ernst, Stamminger, "A Hybrid
// GPU-CPU Renderer", 2005.

#import "shared/footprint.wgsl"
#import "shared/receiver.wgsl"
#import "shared/area_lights.wgsl"

struct Params {
    bias: f32,
    footprint: u32,
}

var<uniform> params: Params;
var<storage, read> area_lights: array<LightSlot>;
var maps: texture_depth_2d_array;
var visibility: texture_storage_2d<r32float, write>;
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
    textureStore(visibility, pixel, vec4(f32(initial_visibility(pixel_status))));
}

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
        for (var y = asked.first.y; y <= asked.last.y; y += asked.step) {
            for (var x = asked.first.x; x <= asked.last.x; x += asked.step) {
                let stored = textureLoad(maps, vec2(x, y), point, 0);
                // 1 is what the maps were cleared to: no caster, however far.
                let is_lit = stored >= 1.0 || place.z <= stored + params.bias;
                lit &= is_lit;
                shadowed &= !is_lit;
            }
        }
        if !lit && !shadowed {
            return STATUS_UNCERTAIN;
        }
    }
    return select(STATUS_SHADOW, STATUS_LIGHT, lit);
}
