#import "shared/receiver.wgsl"
var crossed: texture_2d<f32>;
var stencil: texture_2d<u32>;
struct Answer { @location(0) visibility: u32, @location(1) status: u32 }

fn answer(pixel: vec2<u32>, shadow: bool) -> Answer {
    var status = initial_status(pixel, textureLoad(position, pixel, 0));
    if status == STATUS_UNCERTAIN { status = select(STATUS_LIGHT, STATUS_SHADOW, shadow); }
    return Answer(initial_visibility(status), status);
}
@fragment fn blended(@builtin(position) centre: vec4<f32>) -> Answer {
    return answer(vec2<u32>(centre.xy), textureLoad(crossed, vec2<u32>(centre.xy), 0).x > 0.5);
}
@fragment fn in_stencil(@builtin(position) centre: vec4<f32>) -> Answer {
    return answer(vec2<u32>(centre.xy), textureLoad(stencil, vec2<u32>(centre.xy), 0).x != 0u);
}
