#import "shared/light.wgsl"
#import "shared/camera.wgsl"
#import "shared/receiver.wgsl"
#import "slab.wgsl"

struct Params { bias: f32, cascades: u32 }
var<uniform> params: Params;
var<storage, read> slabs: array<Slab>;
var maps: texture_depth_2d_array;
var closer: sampler_comparison;

struct Answer { @location(0) visibility: u32, @location(1) status: u32, @location(2) soft: f32, @location(3) which: u32 }

@fragment
fn fragment(@builtin(position) centre: vec4<f32>) -> Answer {
    let pixel = vec2<u32>(centre.xy);
    let receiver = textureLoad(position, pixel, 0);
    var status = initial_status(pixel, receiver);
    var soft = 1.0;
    var which = 255u;
    if status == STATUS_UNCERTAIN {
        let distance = dot(camera.forward, relative_to_eye(receiver.xyz));
        which = 0u;
        while which < params.cascades && distance > slabs[which].end { which++; }
        if which < params.cascades {
            let clip = slabs[which].light.clip_from_relative * vec4(receiver.xyz - light.centre.xyz, 1.0);
            soft = textureSampleCompareLevel(maps, closer, vec2(clip.x, -clip.y) * 0.5 + 0.5, which, clip.z - params.bias);
        }
        status = select(STATUS_SHADOW, STATUS_LIGHT, soft >= 0.5);
    }
    return Answer(initial_visibility(status), status, soft, which);
}
