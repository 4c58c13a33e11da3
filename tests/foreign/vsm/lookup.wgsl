#import "shared/light.wgsl"
#import "shared/receiver.wgsl"

struct Params { min_variance: f32, bleed: f32, threshold: f32 }
var<uniform> params: Params;
var moments: texture_2d<f32>;
var bilinear: sampler;

struct Answer { @location(0) visibility: u32, @location(1) status: u32, @location(2) soft: f32 }

@fragment
fn fragment(@builtin(position) centre: vec4<f32>) -> Answer {
    return answer(vec2<u32>(centre.xy));
}

fn answer(pixel: vec2<u32>) -> Answer {
    let receiver = textureLoad(position, pixel, 0);
    var status = initial_status(pixel, receiver);
    var soft = 1.0;
    if status == STATUS_UNCERTAIN {
        let clip = light_clip(receiver.xyz);
        let m = textureSampleLevel(moments, bilinear, vec2(clip.x, -clip.y) * 0.5 + 0.5, 0.0).xy;
        let variance = max(m.y - m.x * m.x, params.min_variance);
        let d = clip.z - m.x;
        let p = variance / (variance + d * d);
        soft = select(clamp((p - params.bleed) / (1.0 - params.bleed), 0.0, 1.0), 1.0, d <= 0.0);
        status = select(STATUS_SHADOW, STATUS_LIGHT, soft >= params.threshold);
    }
    return Answer(initial_visibility(status), status, soft);
}
