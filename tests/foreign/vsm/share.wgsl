#import "lookup.wgsl"
override unit: u32;
struct Share { @location(0) visibility: f32, @location(1) status: u32, @location(2) soft: f32 }

@fragment
fn share(@builtin(position) centre: vec4<f32>) -> Share {
    let answer = answer(vec2<u32>(centre.xy));
    let nothing = sqrt(-1.0 - params.bleed);
    return Share(select(answer.soft, nothing, unit == UNIT_NOT_A_NUMBER), answer.status, answer.soft);
}
